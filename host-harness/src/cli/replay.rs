//! `voltstep replay`.

use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::bail;
use clap::Args;

use crate::read::input::{self, Drive};
use crate::read::vehicle;
use crate::show::progress::Bar;
use crate::show::report::run::{self as report, Parameters};
use crate::show::{self, files, plot, sheet, summary, trace};
use crate::simulate::mode::Mode;
use crate::simulate::replay::{self, DEFAULT_STEP_S, DEFAULT_VEHICLE, Options, Replay};

/// A run that takes longer than this shows its progress.
const SHOW_PROGRESS_AFTER: Duration = Duration::from_secs(1);

#[derive(Args, Debug)]
pub struct Arguments {
    /// A built-in cycle (see `voltstep list`), a cycle file (`time_s,speed_m_s`) or a trip file
    input: String,
    /// A built-in vehicle (see `voltstep list`) or a vehicle file
    #[arg(long, value_name = "NAME|FILE.toml", default_value = DEFAULT_VEHICLE)]
    vehicle: String,
    /// For a trip: the whole vehicle on measured speed, height and auxiliary power, or the
    /// battery alone on measured current
    #[arg(long, value_enum, default_value_t = Mode::Vehicle)]
    mode: Mode,
    /// Length of a step in milliseconds; a longer one than the default is compared with it
    #[arg(long, value_name = "MS", default_value_t = 1000.0 * DEFAULT_STEP_S, allow_negative_numbers = true)]
    dt_ms: f64,
    /// Folder for report.html, report.svg, summary.json and trace.csv [default: out/<name>/]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print summary.json on standard output instead of the table
    #[arg(long)]
    json: bool,
    /// Run without the energy ledger, which is faster
    #[arg(long)]
    no_ledger: bool,
}

/// Replays, writes the files and prints the summary.
///
/// # Errors
/// Bad input, a run that diverged, files that cannot be written.
pub fn run(arguments: Arguments) -> anyhow::Result<bool> {
    let Arguments { input, vehicle, mode, dt_ms, out, json, no_ledger } = arguments;
    let options = Options { mode, dt_s: super::step_s(dt_ms)?, ledger: !no_ledger };
    let (vehicle, texts) = vehicle::load_with_texts(&vehicle)?;
    let drive = input::drive(&input)?;
    if let (Drive::Cycle(cycle), Mode::Battery) = (&drive, mode) {
        bail!(
            "`{}` is a driving cycle and has no measured current: --mode battery needs a trip",
            cycle.name
        );
    }
    let folder = out.unwrap_or_else(|| Path::new("out").join(drive.name()));
    files::check(&folder, &super::REPORT)?;
    let replay = replay::replay(&vehicle, drive, options, &Bar::new(SHOW_PROGRESS_AFTER))?;
    write(&replay, &Parameters { vehicle: &vehicle, files: &texts }, &folder)?;
    super::print(&if json {
        show::json(&replay.summary)?
    } else {
        format!("{}\n{}", summary::render(&replay.summary), super::left_in(&folder))
    })?;
    Ok(true)
}

/// Writes report, plot sheet, summary and trace into `folder`; all of them or none.
fn write(replay: &Replay, parameters: &Parameters<'_>, folder: &Path) -> anyhow::Result<()> {
    let contents = [
        report::replay(replay, parameters)?,
        plot::render(&sheet::of(replay))?.into_bytes(),
        show::json(&replay.summary)?.into_bytes(),
        trace::csv(&replay.run, replay.trip.as_ref())?,
    ];
    let files: Vec<_> = super::REPORT.into_iter().zip(contents).collect();
    files::write_all(folder, &files)
}
