//! `voltstep list`.

use comfy_table::CellAlignment;

use crate::read::{battery, cycle, vehicle};
use crate::show::table::table;

/// Prints the built-in cycles, vehicles and batteries.
///
/// # Errors
/// Standard output cannot be written.
pub fn run() -> anyhow::Result<bool> {
    super::print(&tables())?;
    Ok(true)
}

fn tables() -> String {
    let mut cycles = table(&["cycle", "length [s]", "distance [km]", "source"]);
    cycles.column_iter_mut().skip(3).for_each(|c| {
        c.set_cell_alignment(CellAlignment::Left);
    });
    for cycle in cycle::builtin() {
        cycles.add_row([
            cycle.name.clone(),
            format!("{:.0}", cycle.duration_s()),
            format!("{:.3}", cycle.distance_km()),
            format!("{}; {}", cycle.title, cycle.source),
        ]);
    }
    let mut vehicles = table(&["vehicle", "description", "source"]);
    vehicles.column_iter_mut().skip(1).for_each(|c| {
        c.set_cell_alignment(CellAlignment::Left);
    });
    for vehicle in vehicle::builtin() {
        vehicles.add_row([vehicle.name, vehicle.description, vehicle.source]);
    }
    let mut batteries = table(&["battery", "description", "source"]);
    batteries.column_iter_mut().skip(1).for_each(|c| {
        c.set_cell_alignment(CellAlignment::Left);
    });
    for battery in battery::builtin() {
        batteries.add_row([battery.name, battery.description, battery.source]);
    }
    for table in [&mut cycles, &mut vehicles, &mut batteries] {
        table.set_content_arrangement(comfy_table::ContentArrangement::Dynamic);
        if table.width().is_none() {
            table.set_width(100);
        }
    }
    format!("{cycles}\n\n{vehicles}\n\n{batteries}\n")
}
