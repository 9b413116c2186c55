//! Launch files as they are read.

use super::*;

fn written(name: &str, text: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join(name);
    fs::write(&file, text).unwrap();
    (folder, file)
}

fn read_text(text: &str, given: &[(&str, &str)]) -> Result<Vec<Process>, String> {
    let (_folder, file) = written("a.launch.yaml", text);
    let given: Vec<_> = given.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect();
    processes(&file, &given)
}

const CELL: &str = r#"
launch:
- arg: {name: ns, default: /cell, description: namespace}
- arg: {name: robot, default: ur5e}
- let: {name: rate, value: "20.0"}
- group:
  - push_ros_namespace: {namespace: $(var ns)}
  - push_ros_namespace: {namespace: left}
  - set_remap: {from: tf, to: tf_static}
  - set_env: {name: INSIDE, value: "1"}
  - node:
      pkg: reorder_node
      exec: reorder_node
      name: reorder
      output: screen
      respawn: "false"
      args: --foo
      param:
      - from: $(dirname)/p.yaml
      - {name: rate_hz, value: $(var rate)}
      - {name: n, value: 3}
      - {name: flag, value: true}
      - {name: joints, value: [a, b]}
      - name: limits
        param:
        - {name: velocity, value: [1.0, 2.0]}
      remap:
      - {from: joint_states, to: /joint_states}
      env:
      - {name: A, value: B}
- executable:
    cmd: echo hello from $(var robot)
    if: $(eval "'$(var robot)' == 'panda'")
"#;

#[test]
fn a_node_gets_what_launch_would_give_it() {
    let all = read_text(CELL, &[("robot", "panda")]).unwrap();
    let [node, echo] = &all[..] else { panic!("{all:?}") };
    assert_eq!(node.program, Program::Node { package: "reorder_node".into(), executable: "reorder_node".into() });
    let line = node.arguments.join(" ");
    let (before, file) = line.split_once("--params-file ").unwrap();
    assert_eq!(
        before.trim(),
        "--foo --ros-args -r __ns:=/cell/left -r __node:=reorder -r tf:=tf_static -r joint_states:=/joint_states"
    );
    let rest = file.split_once("/p.yaml ").unwrap().1;
    assert_eq!(rest, "-p rate_hz:=20.0 -p n:=3 -p flag:=true -p joints:=[a, b] -p limits.velocity:=[1.0, 2.0]");
    let pair = |name: &str, value: &str| (name.to_owned(), value.to_owned());
    assert_eq!(node.environment, [pair("INSIDE", "1"), pair("A", "B")]);
    // What a group sets ends with it.
    assert_eq!((&echo.program, &echo.environment), (&Program::Command("echo".into()), &Vec::new()));
    assert_eq!(echo.arguments, ["hello", "from", "panda"]);
    assert_eq!(read_text(CELL, &[]).unwrap().len(), 1);
}

#[test]
fn what_launch_refuses_is_refused() {
    for (text, words) in [
        ("launch:\n- node: {pkg: a, exec: b, colour: red}\n", "node has a key colour"),
        ("launch:\n- node: {pkg: a}\n", "node has no exec"),
        ("launch:\n- timer: {period: 1.0}\n", "the action timer is not understood"),
        ("launch:\n- arg: {name: a}\n", "a has no default"),
        ("launch:\n- log: {message: $(var b)}\n", "no variable b"),
        ("launch:\n- node: {pkg: a, exec: b, respawn: \"true\"}\n", "respawn"),
        ("nodes: []\n", "no list `launch`"),
        ("launch: [1\n", "a.launch.yaml"),
    ] {
        let said = read_text(text, &[]).unwrap_err();
        assert!(said.contains(words) && said.contains("a.launch.yaml"), "{said}");
    }
    assert!(read_text(CELL, &[("robto", "ur5e")]).unwrap_err().ends_with("has no argument robto: it has ns, robot"));
}

/// Every shipped file can be read, and starts only what there is.
#[test]
fn the_shipped_launch_files_are_understood() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../launch");
    let mut files = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let file = entry.unwrap().path();
        let found = processes(&file, &[]).unwrap();
        assert!(!found.is_empty());
        for process in found {
            if let Program::Node { package, executable } = process.program {
                assert_eq!(package, "reorder_node");
                assert!(["reorder_node", "mujoco_arm", "dynamixel_arm"].contains(&executable.as_str()), "{executable}");
            }
            // Nothing listens beyond this machine unless it is asked to.
            let loopback = ("ROS_AUTOMATIC_DISCOVERY_RANGE".to_owned(), "LOCALHOST".to_owned());
            assert!(process.environment.contains(&loopback), "{}", file.display());
        }
        files += 1;
    }
    assert!(files >= 5, "{files}");
}
