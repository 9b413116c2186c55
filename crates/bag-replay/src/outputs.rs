//! Where results go: never where they would destroy what they are made from.

use std::fs;
use std::path::{Path, PathBuf};

use planner::pose_bag::{library_of, remove_abandoned};

use crate::bag::LIBRARY;
use crate::error::ReplayError;
use crate::inputs::Input;

/// The file for every bag: `output` itself where it ends in `.mcap`, else one a bag in the folder `output`, which is made. What killed
/// runs left there half written is removed. `searched` is what the bags were looked for in.
///
/// # Errors
/// [`ReplayError`] where a result would take the place of an input, of another result or of anything that no replay made, would be found as an input by the next run,
/// or cannot be written.
pub fn outputs(searched: &[PathBuf], inputs: &[Input], output: &Path) -> Result<Vec<PathBuf>, ReplayError> {
    let is_file = output.extension().is_some_and(|extension| extension == "mcap") && !output.is_dir();
    if is_file && inputs.len() > 1 {
        return Err(ReplayError::OneFile { output: output.to_owned(), bags: inputs.len() });
    }
    let folder = if is_file { folder_of(output) } else { output };
    if !is_file {
        if let Some(searched) = searched.iter().find(|searched| lies_in(folder, searched)) {
            return Err(ReplayError::OutputAmongInputs { output: folder.to_owned(), searched: searched.clone() });
        }
        fs::create_dir_all(folder).map_err(ReplayError::io(folder))?;
    }
    remove_abandoned(folder)?;
    let file = |input: &Input| if is_file { output.to_owned() } else { folder.join(format!("{}.mcap", input.name)) };
    let outputs: Vec<PathBuf> = inputs.iter().map(file).collect();
    let taken = inputs.iter().flat_map(|input| input.files.iter().map(|file| &file.path).chain([&input.path]));
    spare(taken.map(PathBuf::as_path), outputs.iter().map(PathBuf::as_path))?;
    let is_foreign = |path: &&PathBuf| path.exists() && library_of(path).is_none_or(|library| library != LIBRARY);
    if let Some(path) = outputs.iter().find(is_foreign) {
        return Err(ReplayError::Foreign { path: path.clone() });
    }
    Ok(outputs)
}

/// Whether the next search of the folder `searched` would look into `folder`, which need not exist yet.
fn lies_in(folder: &Path, searched: &Path) -> bool {
    let searched = fs::canonicalize(searched).ok().filter(|path| path.is_dir());
    let from = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
    let place = from.ancestors().find_map(|path| fs::canonicalize(path).ok());
    place.zip(searched).is_some_and(|(place, searched)| place.starts_with(searched))
}

fn folder_of(file: &Path) -> &Path {
    file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Refuses results that would take the place of an input, of a file in a folder that is one, or of another result.
///
/// # Errors
/// [`ReplayError::Taken`], and [`ReplayError::Io`] where the folder of a result is not there.
pub fn spare<'a>(
    inputs: impl Iterator<Item = &'a Path>,
    outputs: impl Iterator<Item = &'a Path>,
) -> Result<(), ReplayError> {
    let mut taken: Vec<PathBuf> = inputs.filter_map(|path| path.canonicalize().ok()).collect();
    for path in outputs {
        let in_folder = || Ok(folder_of(path).canonicalize()?.join(path.file_name().unwrap_or_default()));
        let place = path.canonicalize().or_else(|_| in_folder()).map_err(ReplayError::io(path))?;
        if taken.iter().any(|taken| place.starts_with(taken)) {
            return Err(ReplayError::Taken { path: path.to_owned() });
        }
        taken.push(place);
    }
    Ok(())
}
