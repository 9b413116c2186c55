//! How fast bags are read, every message decoded, and in how much memory: `cargo xtask bench bags` runs it.
//!
//! `reading all FOLDER` reads the bags `mcap` and `sqlite3` in a folder, `reading large FILE` one file, which `reading write FILE`
//! writes. What is measured is printed as a JSON object.
#![allow(clippy::unwrap_used)]

use std::path::Path;
use std::time::Instant;

use pose_bag::msg::{Header, Point, Pose, PoseStamped, Quaternion, Time};
use pose_bag::{BagReader, BagWriter, Compression};

const LARGE_BYTES: u64 = 2 << 30;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["all", folder] => {
            let [mcap, sqlite] = ["mcap", "sqlite3"].map(|storage| {
                let started = Instant::now();
                assert_eq!(read(&Path::new(folder).join(storage)), 100_000);
                started.elapsed().as_secs_f64()
            });
            println!(r#"{{"mcap s": {mcap}, "sqlite3 s": {sqlite}}}"#);
        }
        ["large", file] => {
            let started = Instant::now();
            assert!(read(Path::new(file)) > 10_000_000);
            println!(r#"{{"large s": {}, "large MiB": {}}}"#, started.elapsed().as_secs_f64(), peak_mib());
        }
        ["write", file] => write(Path::new(file)),
        _ => println!("usage: reading all FOLDER | large FILE | write FILE"),
    }
}

/// How many poses there are; each is looked at.
fn read(bag: &Path) -> usize {
    let (mut count, mut sum) = (0, 0.0);
    let losses = BagReader::open(bag).unwrap().for_each(&mut |message| {
        let stamped: PoseStamped = message.decode()?;
        sum += stamped.pose.position.x + stamped.pose.orientation.w + stamped.header.frame_id.len() as f64;
        count += 1;
        Ok(())
    });
    assert!(losses.unwrap().is_empty() && sum.is_finite());
    count
}

fn write(file: &Path) {
    let mut bag = BagWriter::create_with(file, Compression::None).unwrap();
    // A record has 31 bytes of framing, channel and times, and 84 of the message.
    for k in 0..LARGE_BYTES / 115 {
        let header = Header { stamp: Time::from_nanos(k as i64).unwrap(), frame_id: "base".into() };
        let position = Point { x: k as f64, y: 0.5, z: -0.25 };
        let orientation = Quaternion { x: 0.0, y: 0.0, z: 0.0, w: 1.0 };
        bag.write("/tool", k, &PoseStamped { header, pose: Pose { position, orientation } }).unwrap();
    }
    bag.finish().unwrap();
}

/// The most memory that this process ever had in use.
fn peak_mib() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|line| line.starts_with("VmHWM:")).unwrap();
    line.split_whitespace().nth(1).unwrap().parse::<f64>().unwrap() / 1024.0
}
