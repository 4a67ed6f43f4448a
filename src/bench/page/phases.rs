//! docs/phases.md: what several phases cost a scene that has none.

use super::runs::{STRETCH, stretch_row};
use super::{table, where_and_when};
use crate::bench::phases::PhasesRun;
use crate::bench::scenes::Stretch;

/// First line of the page.
pub const MADE: &str =
    "<!-- Written by `sandgate bench phases` from a stored run; do not edit. -->";

/// The whole page. The same run gives the same bytes.
#[must_use]
pub fn text(run: &PhasesRun) -> String {
    let found = &run.phases;
    let alone = found.stretches[0].cost();
    let row = |stretch: &Stretch| {
        let mut row = stretch_row(stretch);
        row.truncate(STRETCH.len() - 1);
        row.push(format!("{:.3}", stretch.cost() / alone));
        row
    };
    let rows: Vec<Vec<String>> = found.stretches.iter().map(row).collect();
    let mut head = STRETCH.to_vec();
    head.pop();
    head.push("CPU time over sand alone");
    let warning = if run.quick {
        "**These are the short stretches of `--quick`: they judge nothing.**\n\n"
    } else {
        ""
    };
    let same = if found.same {
        "the same"
    } else {
        "**not the same**"
    };
    format!(
        "{MADE}\n# What phases cost a scene that has none\n\n{warning}The column of `cases/column_collapse.toml` from its release \
         on, alone and with other phases in the scene, on {}. One thread, communication steps of 10 ms, in turns; of each the median \
         of {} repetitions counts. *The same once more* is how far two equal runs are apart.\n\n{}\n\nWith materials that nothing is \
         made of, particles end at {same} places, velocities and pressures as without, bit by bit: such materials are left out before a solver is made \
         (`src/scene/lift/unused.rs`). The tubs hold 10 by 5 particles at rest beyond the reach of the sand; what they cost beside \
         the tub of the same sand is what their phase asks of all: one acoustic step to a solve for two, forms of the sweeps that know \
         fluids, the search of where materials meet, pore pressure. A scene without that phase has none of it, computed or stored \
         (`has_fluids`, `has_pores`, `has_meetings` in `src/solver/start.rs`).\n\n## How to repeat it\n\n```\ncargo run --release -- bench phases --page \
         docs/phases.md\n```\n\nIt takes a minute, keeps the run in `benches/runs/`, and writes this page from it; `--only-page` writes \
         the page from the kept run.\n",
        where_and_when(&run.machine),
        run.repeats,
        table(&head, &rows)
    )
}
