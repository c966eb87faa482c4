#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| canter_fuzz::axis::run(data));
