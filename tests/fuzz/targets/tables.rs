//! Any bytes as a table: an error, or numbers that are finite and as many as promised.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pose_bag::Table;

fuzz_target!(|bytes: &[u8]| {
    let Ok(table) = Table::from_reader(bytes, "fuzz") else { return };
    assert_eq!(table.line_numbers().count(), table.len());
    let columns: Vec<&str> = table.columns().iter().map(String::as_str).collect();
    if let Ok(rows) = table.select(&columns) {
        assert_eq!(rows.len(), table.len());
        assert!(rows.iter().all(|row| row.len() == columns.len() && row.iter().all(|x| x.is_finite())));
    }
    if let Ok(poses) = table.poses() {
        assert!(poses.iter().all(|pose| (pose.rotation.norm() - 1.0).abs() < 1e-9));
    }
});
