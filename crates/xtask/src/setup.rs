//! The set-up: an ordered list of steps, each done once and redone only when its recipe changes.

use crate::env::Layout;
use crate::failure::{Failure, Outcome};
use crate::{browser, interfaces, mujoco, python, ros, wheel};
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// One thing that the set-up makes.
pub(crate) struct Step {
    pub(crate) name: &'static str,
    /// All that the result depends on. The stamp of a finished step holds it; another recipe means: do it again.
    pub(crate) recipe: String,
    /// Exists once the step is done, so that a deleted folder is made again whatever the stamp says.
    pub(crate) result: PathBuf,
    pub(crate) make: Box<dyn FnOnce(&Layout) -> Outcome>,
}

/// Brings what the demo needs in `.deps` up to date.
pub(crate) fn run(layout: &Layout) -> Outcome {
    take(layout, steps(layout)?)
}

/// Brings all in `.deps` up to date: also what draws the report's page, what builds the Python package, and what
/// tests both.
pub(crate) fn run_for_tests(layout: &Layout) -> Outcome {
    let mut steps = steps(layout)?;
    steps.push(browser::step(layout, &python::step(layout).recipe));
    steps.push(wheel::step(layout));
    take(layout, steps)
}

fn steps(layout: &Layout) -> Outcome<Vec<Step>> {
    let python = python::step(layout);
    // What is made from the Python environment is made again with it.
    let upstream = python.recipe.clone();
    let mut steps = vec![python, mujoco::step(layout, &upstream), ros::libclang_step(layout, &upstream)?];
    match layout.sourced_ros() {
        Some(prefixes) => ros::check_sourced(layout, &prefixes)?,
        None => {
            let interfaces = interfaces::build_step(layout, &upstream)?;
            let upstream = interfaces.recipe.clone();
            steps.extend([interfaces, interfaces::python_step(layout, &upstream), ros::prefix_step(layout, &upstream)]);
        }
    }
    Ok(steps)
}

/// Takes some steps in `.deps`, those that are due.
pub(crate) fn take(layout: &Layout, steps: Vec<Step>) -> Outcome {
    let deps = layout.deps();
    fs::create_dir_all(deps.join("stamps")).map_err(Failure::io("create", deps.join("stamps")))?;
    let _lock = lock(&deps.join("lock"))?;
    bring_up_to_date(layout, steps)
}

fn bring_up_to_date(layout: &Layout, steps: Vec<Step>) -> Outcome {
    let count = steps.len();
    for (index, step) in steps.into_iter().enumerate() {
        print!("[{}/{count}] {} … ", index + 1, step.name);
        std::io::stdout().flush().map_err(Failure::io("write to", "the terminal"))?;
        let started = Instant::now();
        let stamp = layout.deps().join("stamps").join(step.result.file_name().unwrap_or_default());
        if step.result.exists() && fs::read_to_string(&stamp).is_ok_and(|recipe| recipe == step.recipe) {
            println!("up to date");
            continue;
        }
        if let Err(failure) = (step.make)(layout) {
            println!("failed");
            return Err(failure);
        }
        write_whole(&stamp, &step.recipe)?;
        println!("done in {:.1} s", started.elapsed().as_secs_f64());
    }
    Ok(())
}

/// Two set-ups at once would tread on each other: the second waits, and then finds all up to date.
fn lock(path: &Path) -> Outcome<File> {
    let file = File::create(path).map_err(Failure::io("create", path))?;
    if file.try_lock().is_err() {
        println!("waiting for another set-up to finish");
        file.lock().map_err(Failure::io("lock", path))?;
    }
    Ok(file)
}

fn write_whole(path: &Path, text: &str) -> Outcome {
    let partial = path.with_extension("partial");
    fs::write(&partial, text).map_err(Failure::io("write", &partial))?;
    fs::rename(&partial, path).map_err(Failure::io("write", path))
}

/// Makes a folder all or not at all: `fill` works on a folder beside it, which then takes its place.
pub(crate) fn replace_folder(folder: &Path, fill: impl FnOnce(&Path) -> Outcome) -> Outcome {
    let partial = folder.with_extension("partial");
    remove_folder(&partial)?;
    fs::create_dir_all(&partial).map_err(Failure::io("create", &partial))?;
    fill(&partial)?;
    remove_folder(folder)?;
    fs::rename(&partial, folder).map_err(Failure::io("create", folder))
}

pub(crate) fn remove_folder(folder: &Path) -> Outcome {
    match fs::remove_dir_all(folder) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(Failure::io("remove", folder)(error)),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;
    use std::rc::Rc;

    struct Bench {
        _folder: tempfile::TempDir,
        layout: Layout,
        result: PathBuf,
        made: Rc<Cell<u32>>,
    }

    impl Bench {
        fn new() -> Self {
            let folder = tempfile::tempdir().unwrap();
            let layout = Layout::at(folder.path());
            fs::create_dir_all(layout.deps().join("stamps")).unwrap();
            let result = layout.deps().join("thing");
            Self { _folder: folder, layout, result, made: Rc::default() }
        }

        /// Offers the step to the set-up, and says how often it has been made so far.
        fn offer(&self, recipe: &str, succeeds: bool) -> u32 {
            let (made, result) = (self.made.clone(), self.result.clone());
            let make = Box::new(move |_: &Layout| {
                made.set(made.get() + 1);
                replace_folder(&result, |folder| {
                    fs::write(folder.join("half"), "").unwrap();
                    let detail = "on purpose".to_owned();
                    if succeeds { Ok(()) } else { Err(Failure::Step { what: "thing".to_owned(), detail }) }
                })
            });
            let step = Step { name: "thing", recipe: recipe.to_owned(), result: self.result.clone(), make };
            assert_eq!(bring_up_to_date(&self.layout, vec![step]).is_ok(), succeeds);
            self.made.get()
        }
    }

    #[test]
    fn a_step_is_made_once_and_again_for_another_recipe_or_when_its_result_is_gone() {
        let bench = Bench::new();
        assert_eq!(bench.offer("old", true), 1);
        assert_eq!(bench.offer("old", true), 1);
        assert_eq!(bench.offer("new", true), 2);
        fs::remove_dir_all(&bench.result).unwrap();
        assert_eq!(bench.offer("new", true), 3);
    }

    #[test]
    fn a_failed_step_leaves_no_result_and_is_tried_again() {
        let bench = Bench::new();
        assert_eq!(bench.offer("recipe", false), 1);
        assert!(!bench.result.exists());
        assert_eq!(bench.offer("recipe", true), 2);
        assert_eq!(
            fs::read_dir(bench.layout.deps()).unwrap().count(),
            2,
            "the result and the stamps, nothing half-made"
        );
    }
}
