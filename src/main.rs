//! epiline
fn main() {}
