//! Text files that appear whole or not at all.

use std::fs::Permissions;
use std::io::Write;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;

use mujoco_sim::planner::se3_geom::xyzw_from_rotation;
use mujoco_sim::{Execution, SimError};

/// Writes text beside its destination and moves it there when it is complete.
pub(crate) fn write_whole(path: &Path, text: &str) -> Result<(), SimError> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let write = || -> std::io::Result<()> {
        // Temporary files are private otherwise; the umask takes away from this as from any new file.
        let public = Permissions::from_mode(0o666);
        let mut pending = tempfile::Builder::new().permissions(public).tempfile_in(folder)?;
        pending.write_all(text.as_bytes())?;
        pending.persist(path)?;
        Ok(())
    };
    write().map_err(|error| SimError::Write { file: path.display().to_string(), reason: error.to_string() })
}

/// The samples as CSV: `t`; reference, position and velocity of every joint; the tool as `x,y,z,qx,qy,qz,qw`. SI units.
pub(crate) fn execution_csv(execution: &Execution) -> String {
    let mut header = vec!["t".to_owned()];
    for kind in ["reference", "position", "velocity"] {
        header.extend(execution.joints.iter().map(|joint| format!("{}.{kind}", joint.name)));
    }
    header.extend(["x", "y", "z", "qx", "qy", "qz", "qw"].map(str::to_owned));
    let mut text = header.join(",") + "\n";
    for sample in &execution.samples {
        let Some(tool) = execution.tool_at(sample.time_s) else { continue };
        let joints = sample.reference.iter().chain(&sample.position).chain(&sample.velocity).copied();
        let quaternion_xyzw = xyzw_from_rotation(&tool.rotation);
        let pose = tool.translation.vector.iter().copied().chain(quaternion_xyzw);
        let row: Vec<String> = [sample.time_s].into_iter().chain(joints).chain(pose).map(|x| x.to_string()).collect();
        text += &(row.join(",") + "\n");
    }
    text
}
