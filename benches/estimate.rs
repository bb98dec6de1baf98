//! Throughput of the whole estimate.
fn main() {}
