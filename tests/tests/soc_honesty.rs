//! The Kalman filter where the world is not as assumed: `cargo run --release -- soc --matrix` prints
//! the same with more seeds.

use voltstep::evaluate::estimators::honesty::{Chemistry, Group, Kind, Report};

/// Fewer than the command's: enough to see a kind fail.
const SEEDS: u64 = 3;

#[test]
fn its_standard_deviation_can_be_believed() {
    let report = Report::of(SEEDS);
    let happen = |kind: Kind| Chemistry::ALL.into_iter().filter(move |c| kind.happens_to(*c));
    assert_eq!(report.groups.len(), Kind::ALL.into_iter().flat_map(happen).count());
    for group in &report.groups {
        let (mean, worst) = group.inside();
        assert!(
            group.is_honest(),
            "{:?} on {:?}: inside {mean}, at worst {worst}, silent {}, flagged {}, largest error {} sd, \
             sd {}, error over sd {}",
            group.kind,
            group.chemistry,
            group.silent(),
            group.flagged(),
            group.worst(),
            group.sd(),
            group.ratio()
        );
        // Otherwise that says nothing.
        assert!(group.sd() > 0.0, "{group:?}");
    }
    // A flag says something only where it is not always there.
    let flagged = |kind| {
        let on_cell = |group: &&Group| group.kind == kind && group.chemistry == Chemistry::Cell;
        report.groups.iter().find(on_cell).unwrap().flagged()
    };
    assert!(flagged(Kind::Reversed) > 0.9 && flagged(Kind::Clean) < 0.005);
}
