//! Throughput of the line-matching kernel.
fn main() {}
