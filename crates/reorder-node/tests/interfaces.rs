//! The message packages that the set-up builds are those of everybody else.
#![allow(clippy::unwrap_used, missing_docs)]

use std::path::{Path, PathBuf};

/// Type hashes (REP 2016) of the public Jazzy builds: peers with another hash do not hear each other.
const HASHES: [(&str, &str, &str); 6] = [
    (
        "control_msgs/action/FollowJointTrajectory",
        "control_msgs/action/FollowJointTrajectory",
        "738ebcb7a2d7cfa42f9f1001cc99ce3a4383d1cfe508015d9be8485e4b1c66f6",
    ),
    (
        "control_msgs/action/FollowJointTrajectory",
        "control_msgs/action/FollowJointTrajectory_SendGoal",
        "b13789dddc325a7a962825c45e28c77d37237ec129dd0c34dc5994562938c57f",
    ),
    (
        "control_msgs/action/FollowJointTrajectory",
        "control_msgs/action/FollowJointTrajectory_GetResult",
        "e3ceb38e3e1867c8dc0f46014df26e90eb93422f27e9e97f936e07f94be4bc8b",
    ),
    (
        "control_msgs/action/FollowJointTrajectory",
        "control_msgs/action/FollowJointTrajectory_FeedbackMessage",
        "80398fcb9674a79081a9906e2ccf0c804dd7cb15e22e362e606ee87186beab71",
    ),
    (
        "control_msgs/msg/JointTolerance",
        "control_msgs/msg/JointTolerance",
        "c254f9cece0f3b733017b6990fd46d1326e25242d6b8844398c97d9a88e7d648",
    ),
    (
        "tf2_msgs/msg/TFMessage",
        "tf2_msgs/msg/TFMessage",
        "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087",
    ),
];

/// `share/<file>.json` in the first prefix that has it.
fn description(file: &str) -> serde_json::Value {
    let prefixes = std::env::var("AMENT_PREFIX_PATH").unwrap();
    let place = |prefix: PathBuf| prefix.join("share").join(Path::new(file).with_extension("json"));
    let found = std::env::split_paths(&prefixes).map(place).find(|path| path.exists());
    serde_json::from_str(&std::fs::read_to_string(found.unwrap()).unwrap()).unwrap()
}

#[test]
fn type_hashes_are_those_of_the_public_builds() {
    for (file, name, hash) in HASHES {
        let hashes = description(file)["type_hashes"].as_array().unwrap().clone();
        let ours = hashes.iter().find(|entry| entry["type_name"] == name).unwrap();
        assert_eq!(ours["hash_string"], format!("RIHS01_{hash}"), "{name}");
    }
}
