#![no_main]
libfuzzer_sys::fuzz_target!(|data: &[u8]| voltstep_fuzz::check(data));
