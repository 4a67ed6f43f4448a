//! The studies themselves, before any run.

use super::*;

/// Every member of every study is a scene, has the variables it keeps, and has a name that makes a file name.
#[test]
fn the_studies_are_sound() {
    for study in studies::ALL {
        for effort in [Effort::Full, Effort::Quick] {
            let members = (study.members)(effort).unwrap();
            assert!(!members.is_empty());
            let mut names = std::collections::BTreeSet::new();
            for member in &members {
                let job = Job {
                    study: study.name,
                    member,
                };
                let scene = job.scene().unwrap_or_else(|e| panic!("{e}"));
                let table = crate::component::VariableTable::of(&scene);
                for name in &member.plan.series {
                    assert!(
                        table.by_name(name).is_some(),
                        "{} {}: {name}",
                        study.name,
                        member.name
                    );
                }
                assert!(member.plan.snapshots.iter().all(|t| *t <= scene.run.until));
                let plain =
                    |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || "_.".contains(c);
                assert!(member.name.chars().all(plain), "{}", member.name);
                assert!(names.insert(member.name.clone()), "{} twice", member.name);
            }
            // Without a single result a page is still made, and nothing is met.
            let report = (study.analyse)(&Results::new(effort, None, Vec::new())).unwrap();
            assert_eq!(report.count(Verdict::Met), 0, "{}", study.name);
            assert!(report.count(Verdict::NoResult) > 0, "{}", study.name);
            assert_eq!(report.count(Verdict::NoResult), report.metrics.len());
        }
    }
}
