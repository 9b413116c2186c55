//! Whether a figure was drawn.

use std::error::Error;
use std::path::Path;

/// Draws into a directory of its own, and looks whether there are the lines and dots, of finite numbers and within the picture.
/// `lines` counts those of the legend too.
pub(crate) fn assert_drawn(lines: usize, dots: usize, draw: impl Fn(&Path) -> Result<(), Box<dyn Error>>) {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("figure.svg");
    draw(&path).unwrap();
    let svg = std::fs::read_to_string(&path).unwrap();
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"), "{svg}");
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    assert_eq!(svg.matches("<circle").count(), dots);
    let attribute = |element: &str, name: &str| -> Vec<f64> {
        let value = element.split(&format!(" {name}=\"")).nth(1).unwrap().split('"').next().unwrap();
        value.split([',', ' ']).filter(|x| !x.is_empty()).map(|x| x.parse().unwrap()).collect()
    };
    let size = [attribute(&svg, "width")[0], attribute(&svg, "height")[0]];
    // The axes are thinner.
    let drawn: Vec<_> = svg.lines().filter(|x| x.contains("<polyline") && x.contains("stroke-width=\"2\"")).collect();
    assert_eq!(drawn.len(), lines);
    for line in drawn {
        let points = attribute(line, "points");
        assert!(points.len() >= 4, "{line}");
        assert!(points.chunks(2).all(|p| p.iter().zip(size).all(|(x, most)| (0.0..=most).contains(x))), "{line}");
    }
}
