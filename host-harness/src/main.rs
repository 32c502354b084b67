//! The command `voltstep`. Exit codes: 0 good, 1 a check failed, 2 bad usage or input.

use std::process::ExitCode;

fn main() -> ExitCode {
    voltstep::cli::main()
}
