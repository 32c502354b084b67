//! Running other programs from the root of the workspace.

use std::io::ErrorKind;
use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, anyhow, bail};

/// Tools that do not come with Rust, and Debian's packages that hold them.
pub const TOOLS: &[(&str, &str)] = &[
    ("qemu-system-arm", "qemu-system-arm"),
    ("arm-none-eabi-gcc", "gcc-arm-none-eabi"),
    ("arm-none-eabi-nm", "gcc-arm-none-eabi"),
    ("arm-none-eabi-size", "gcc-arm-none-eabi"),
    ("ngspice", "ngspice"),
    ("chromium", "chromium"),
    ("python3", "python3-venv"),
    ("cc", "gcc"),
];

/// A program, to be run in the root of the workspace.
pub fn program(name: &str) -> Command {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent();
    let mut command = Command::new(name);
    command.current_dir(root.expect("xtask lies in a folder of the workspace"));
    command
}

/// The cargo that started this program.
pub fn cargo() -> Command {
    program(&std::env::var("CARGO").unwrap_or_else(|_| String::from("cargo")))
}

/// Shows a command, runs it and demands success.
pub fn run(command: &mut Command) -> Result<()> {
    let line = line(command);
    println!("> {line}");
    let status = command.status().map_err(|error| cannot_start(command, error))?;
    if !status.success() {
        bail!("`{line}` ended with {status}");
    }
    Ok(())
}

/// Runs a command, demands success and returns what it wrote to standard output.
pub fn output(command: &mut Command) -> Result<String> {
    let line = line(command);
    let output =
        command.stderr(Stdio::inherit()).output().map_err(|error| cannot_start(command, error))?;
    if !output.status.success() {
        bail!("`{line}` ended with {}", output.status);
    }
    String::from_utf8(output.stdout).with_context(|| format!("`{line}` wrote no UTF-8"))
}

fn cannot_start(command: &Command, error: std::io::Error) -> anyhow::Error {
    let name = command.get_program().to_string_lossy();
    if error.kind() != ErrorKind::NotFound {
        return anyhow!(error).context(format!("cannot start `{name}`"));
    }
    let package =
        TOOLS.iter().find(|(tool, _)| *tool == name).map_or(String::new(), |(_, package)| {
            format!(": Debian's package `{package}` has it, `cargo xtask setup` installs that")
        });
    anyhow!("`{name}` is not installed or not on the PATH{package}")
}

/// The command as one would type it; a program given by its path is shown by its name.
fn line(command: &Command) -> String {
    let name = Path::new(command.get_program()).file_name().unwrap_or(command.get_program());
    let words = std::iter::once(name).chain(command.get_args());
    words.map(|word| word.to_string_lossy()).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_as_typed() {
        assert_eq!(line(Command::new("/bin/cargo").args(["fmt", "--all"])), "cargo fmt --all");
    }

    #[test]
    fn a_missing_program_is_named() {
        let error = run(&mut program("no-such-program-voltstep")).unwrap_err();
        assert!(error.to_string().contains("no-such-program-voltstep"));
        assert!(error.to_string().contains("not installed"));
    }

    #[test]
    fn the_package_of_a_missing_tool_is_named() {
        let missing = std::io::Error::from(ErrorKind::NotFound);
        let error = cannot_start(&program("arm-none-eabi-nm"), missing).to_string();
        assert!(error.contains("`gcc-arm-none-eabi`"), "{error}");
    }

    #[test]
    fn failure_is_an_error() {
        assert!(run(cargo().arg("--no-such-option")).is_err());
        assert!(output(cargo().arg("--no-such-option")).is_err());
        assert!(output(cargo().arg("--version")).unwrap().starts_with("cargo"));
    }
}
