//! The numbers that the README's gallery prints: each is what its program computes, to half a unit of the last printed digit.
#![allow(clippy::unwrap_used, clippy::duplicate_mod)]

#[allow(dead_code)]
#[path = "../examples/figure_4_1.rs"]
mod figure_4_1;
#[allow(dead_code)]
#[path = "../examples/figure_4_11.rs"]
mod figure_4_11;
#[allow(dead_code)]
#[path = "../examples/figure_4_13.rs"]
mod figure_4_13;
#[allow(dead_code)]
#[path = "../examples/figure_4_2.rs"]
mod figure_4_2;
#[allow(dead_code)]
#[path = "../examples/figure_4_5.rs"]
mod figure_4_5;
#[allow(dead_code)]
#[path = "../examples/figure_5_5.rs"]
mod figure_5_5;
#[allow(dead_code)]
#[path = "../examples/figure_6_1.rs"]
mod figure_6_1;
#[allow(dead_code)]
#[path = "../examples/figure_6_3.rs"]
mod figure_6_3;
#[allow(dead_code)]
#[path = "../examples/figure_c_1.rs"]
mod figure_c_1;
#[allow(dead_code)]
#[path = "../examples/figures_4_8_to_4_10.rs"]
mod figures_4_8_to_4_10;

const README: &str = include_str!("../README.md");

/// The cell "ours" of a figure's row.
fn ours(figure: &str) -> &'static str {
    let row = README.lines().find(|line| line.starts_with(&format!("| {figure} | ["))).unwrap();
    row.trim_end_matches(" |").rsplit(" | ").next().unwrap()
}

/// Numbers that are printed with at least four decimals.
fn decimals(text: &str) -> Vec<&str> {
    let tokens = text.split(|c: char| !(c.is_ascii_digit() || c == '.')).map(|token| token.trim_end_matches('.'));
    tokens.filter(|token| token.split_once('.').is_some_and(|(_, decimals)| decimals.len() >= 4)).collect()
}

fn assert_printed(figure: &str, numbers: &[(&str, f64)]) {
    for (printed, computed) in numbers {
        assert!(decimals(ours(figure)).contains(printed), "{figure}: {printed} is not printed");
        let (_, decimals) = printed.split_once('.').unwrap();
        let half_unit = 0.5 * 0.1_f64.powi(decimals.len() as i32);
        let error = (printed.parse::<f64>().unwrap() - computed).abs();
        assert!(error <= half_unit, "{figure}: {printed} is printed, {computed} comes out");
    }
    for printed in decimals(ours(figure)) {
        assert!(numbers.iter().any(|(asserted, _)| *asserted == printed), "{figure}: nobody computes {printed}");
    }
}

#[test]
fn surfaces_are_printed_as_computed() {
    let flow = figure_4_1::compute().unwrap();
    let [first, last] = [&flow.stages[0], &flow.stages[5]].map(|stage| stage.length);
    assert_printed("4.1", &[("2.9174", first), ("1.414213562", last)]);
    let geodesics = figure_4_2::compute().unwrap();
    let lengths = [&geodesics.saddle, &geodesics.egg_box].map(|case| case.geodesic_length);
    assert_printed("4.2", &[("3.595705578", lengths[0]), ("9.131171260", lengths[1])]);
    let hill = figure_4_5::compute().unwrap();
    let scipy: serde_json::Value = serde_json::from_str(include_str!("data/monge_bvp.json")).unwrap();
    let exact = scipy["cases"][5]["length"].as_f64().unwrap();
    let [below, above] = hill.lengths;
    assert_printed("4.5", &[("4.7921", below), ("4.7921", above), ("4.7957", hill.distance), ("4.7916", exact)]);
    let medial = figure_5_5::compute().unwrap();
    assert_printed("5.5", &[("6.686496", medial.normal_length), ("6.283185", std::f64::consts::TAU)]);
}

#[test]
fn motions_are_printed_as_computed() {
    let segments = figures_4_8_to_4_10::compute();
    let lengths = segments.motions.iter().flat_map(|m| &m.segments).map(|s| (s[2] - s[0]).hypot(s[3] - s[1]));
    let off = lengths.map(|length| (length - 1.0).abs()).fold(0.0, f64::max);
    assert!(ours("4.8–4.10").contains("length 1 within 4e-16") && off <= 4e-16, "{off:e}");
    let plane = figure_4_11::compute().unwrap();
    assert_printed("4.11", &[("6.2694", plane.curve_length), ("5.3852", plane.geodesic_length)]);
    let geodesic = figure_4_13::compute().unwrap();
    assert_printed("4.13", &[("1.719365", geodesic.angle_rad), ("8.885731", geodesic.distance)]);
}

#[test]
fn curves_are_printed_as_computed() {
    let frames = figure_6_1::compute().unwrap();
    let [geodesic, product, group] = [&frames.geodesic, &frames.product, &frames.group].map(|curve| curve.length);
    assert_printed("6.1", &[("10.1226", geodesic), ("10.3932", product), ("10.4258", group)]);
    let spline = figure_6_3::compute().unwrap();
    assert_printed("6.3", &[("15.7640", spline.length)]);
    let jumps = spline.arriving.iter().zip(&spline.leaving);
    let jump = jumps.flat_map(|(before, after)| [1, 2].map(|k| (after[k] - before[k]).norm())).fold(0.0, f64::max);
    assert!(ours("6.3").contains("below 2e-15") && jump < 2e-15, "{jump:e}");
    let turned = figure_c_1::compute().unwrap();
    assert_printed("C.1", &[("1.8403024", turned.limit_rad)]);
}
