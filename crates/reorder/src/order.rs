//! The order of points on any manifold, with what speaks for and against it.

use se3_geom::Manifold;
use tracing::debug_span;

use crate::agreement::{ENOUGH_DOUBTS, Variant, examine_sequence, of_trees};
use crate::certificate::Certificate;
use crate::components::{Split, split};
use crate::curve::Curve;
use crate::denoise::denoised;
use crate::doubts::{self, Doubts};
use crate::error::{OrderError, check_points};
use crate::finish::{order_as_one, ordered};
use crate::independence::look_independent;
use crate::ordering::{
    Doubt, Method, MethodChoice, Options, Ordering, Repair, Repaired, Topology, TopologyChoice, Verdict,
};
use crate::recovery::{Recovery, recover, rows_along};
use crate::repair::{Sequence, TURNING, sequence};
use crate::sweep::sweep;
use crate::topology::{beyond_ends, rotate_to};
use crate::tour::Problem;
use crate::walk::{far_end, is_path};

/// Sets of more points are repaired only on demand: the searches would take minutes.
pub const MOST_REPAIRED_UNASKED: usize = 3000;

/// Sets of more points are not denoised: the nearest of every point are sought among all, which would take minutes too.
pub const MOST_DENOISED: usize = 30_000;

/// So many points in a row may be in dispute where a curve crosses itself or turns sharply; where it runs beside itself, many more
/// are.
const LONGEST_DISPUTE: usize = 12;

/// What is said of edges of the tree that a search leaves for a path that is not taken.
const LEFT: &str = "a shorter path that turns less does not join these two, but turns back elsewhere";
/// So many of them are named.
const MOST_LEFT: usize = 20;

/// Orders points sampled from a curve, by the exact minimum spanning tree under the manifold's own distance, and by a short path
/// of little turning where that tree is no order to trust.
///
/// Where the tree is a path that nothing speaks against, that path is the order, and the verdict [`Verdict::Plausible`]. Elsewhere,
/// unless [`Options::repair`] says otherwise, the order is repaired: see [`Method::Repaired`]; but a tree that is a path, and nowhere turns
/// back, is kept where the repaired order turns back. What may stand in
/// [`Ordering::doubts`] is listed in the [crate documentation](crate#verdict).
///
/// O(n) memory. The tree and the examination of a path take about O(n log n) time where the manifold has an
/// [`embedding`](Manifold::embedding), and O(n²) elsewhere. The search of a repair takes O(n²) for the near points and many times
/// that for its kicks, unasked up to [`MOST_REPAIRED_UNASKED`] points only; [`Options::denoise`] takes O(n²), up to [`MOST_DENOISED`].
/// NN-CRUST and the nearest-neighbour chain take O(n²); CRUST O(n log n), and O(p²) where its edges fall into p pieces. The neighbourhoods found do not depend on the order of the input, except between equal distances,
/// where smaller rows win, nor on isometries of the manifold beyond rounding.
///
/// # Errors
/// [`OrderError`]: fewer than two distinct points (three for a closed curve), coordinates that are not finite or no point, a start that is out of
/// range or no end of the open curve.
pub fn order<M: Manifold>(manifold: &M, points: &[M::Point], options: &Options) -> Result<Ordering, OrderError> {
    check_points(manifold, points)?;
    ordered(manifold, &[], points, options)
}

/// As [`order`]; the order must be the same under every variant of the metric.
pub(crate) fn order_among<M: Manifold>(
    manifold: &M,
    variants: &[Variant<M>],
    points: &[M::Point],
    options: &Options,
) -> Result<Ordering, OrderError> {
    if options.denoise {
        return order_denoised(manifold, variants, points, options);
    }
    let anywhere = Options { start: None, ..*options };
    let recovery = recover(manifold, points, &anywhere, options.start)?;
    let branches = doubts::of_tree(&recovery.distinct.tree);
    // The tree at each other weight costs as much as the order itself, which nobody can trust where the first one branches all over.
    let weighed = if branches.len() < ENOUGH_DOUBTS { variants } else { &[] };
    // Entered here as well: whoever listens on this thread only would not hear of it from another.
    let phase = debug_span!("certificate").entered();
    let (mut examined, of_weight) = rayon::join(
        || examine_tree(manifold, points, &recovery, branches),
        || of_trees(&recovery, weighed, points, &anywhere),
    );
    drop(phase);
    let of_weight = of_weight?;
    let tree_is_stable = (!weighed.is_empty()).then_some(of_weight.is_empty());
    examined.doubts.searchable.extend(of_weight);
    let joined = options.topology == TopologyChoice::Closed && is_clean_arc(manifold, points, &recovery);
    let mendable = !examined.doubts.searchable.is_empty()
        || recovery.distinct.groups.len() < points.len() && !examined.doubts.firm.is_empty();
    let by_tree = |examined: Examined, recovery, stable| {
        let recovery =
            if options.start.is_some() { recover(manifold, points, options, options.start)? } else { recovery };
        Ok(examined.answer(points.len(), recovery, stable))
    };
    if !mendable || joined || !may_repair(points.len(), options) {
        return by_tree(examined, recovery, tree_is_stable);
    }
    let problem = Problem::new(manifold, points);
    let mut found = sequence(manifold, points, &problem, TURNING, &[], options.topology);
    let name = recovery.names(points.len());
    let (before, after) = (recovery.tree_edges(), found.edges(&name));
    let is_of_tree = after == recovery.edges();
    // A tree that is a path, and nowhere turns back, is not given up for a path that does.
    let turns_back = |rows: &[usize], closed| Curve::new(manifold, points, rows, closed).turns_back();
    if !is_of_tree
        && is_path(&recovery.distinct.tree)
        && turns_back(&found.distinct_rows(&name), found.closed)
        && !turns_back(&recovery.rows, recovery.closed)
    {
        let left = missing(&before, &after).into_iter().take(MOST_LEFT).map(|at| Doubt { at, why: LEFT.to_owned() });
        examined.doubts.searchable.extend(left);
        return by_tree(examined, recovery, tree_is_stable);
    }
    let agreement = examine_sequence(manifold, variants, points, &problem, &found, &before, &name, options);
    if is_of_tree {
        examined.certified = false;
        examined.hear(agreement.doubts);
        return by_tree(examined, recovery, agreement.weight_stable.or(tree_is_stable));
    }
    turn_to_start(&mut found, &name, options.start)?;
    let mut examined = examine_repaired(manifold, points, &found, &name);
    examined.hear(agreement.doubts);
    let mut answer = examined.answer(points.len(), recovery, agreement.weight_stable);
    answer.topology = if found.closed { Topology::Closed } else { Topology::Open };
    answer.order = found.rows;
    answer.method = Method::Repaired;
    answer.repaired = Some(Repaired { dropped: missing(&before, &after), added: missing(&after, &before) });
    Ok(answer)
}

/// One round only: a second one would also pull bends straight.
fn order_denoised<M: Manifold>(
    manifold: &M,
    variants: &[Variant<M>],
    points: &[M::Point],
    options: &Options,
) -> Result<Ordering, OrderError> {
    if points.len() > MOST_DENOISED {
        return Err(OrderError::TooManyToDenoise { count: points.len(), most: MOST_DENOISED });
    }
    // Refuses what cannot be ordered before anything is measured.
    recover(manifold, points, &Options { start: None, ..*options }, options.start)?;
    let (onto_line, moved) = denoised(manifold, points, &Problem::new(manifold, points));
    let mut found = order_as_one(manifold, variants, &onto_line, &Options { denoise: false, ..*options })?;
    // What is certified are the moved points, not the curve that the given ones were sampled from.
    found.verdict = found.verdict.min(Verdict::Plausible);
    let swappable = doubts::of_noise(manifold, &onto_line, &found, &moved);
    if !swappable.is_empty() {
        found.verdict = Verdict::Ambiguous;
        found.doubts.extend(swappable);
    }
    found.moved = moved;
    Ok(found)
}

/// Whether nothing but the way back from its end speaks against the order. A search for a short loop would not go back: it would
/// zigzag through the arc.
fn is_clean_arc<M: Manifold>(manifold: &M, points: &[M::Point], recovery: &Recovery) -> bool {
    let tree = &recovery.distinct.tree;
    if !doubts::of_tree(tree).is_empty() {
        return false;
    }
    let rows = rows_along(tree, far_end(tree));
    let arc = Curve::new(manifold, points, &rows, false);
    let Doubts { firm, searchable, .. } = examine_curve(&arc, &recovery.repeated(points.len()), false).doubts;
    // Equal points may be two passes of a loop that comes back over itself.
    searchable.is_empty() && (firm.is_empty() || recovery.distinct.groups.len() == points.len())
}

fn may_repair(count: usize, options: &Options) -> bool {
    options.method == MethodChoice::Auto
        && match options.repair {
            Repair::Auto => count <= MOST_REPAIRED_UNASKED,
            Repair::Always => true,
            Repair::Off => false,
        }
}

/// Edges of `these` that are not among `those`; both ascending.
fn missing(these: &[(usize, usize)], those: &[(usize, usize)]) -> Vec<[usize; 2]> {
    these.iter().filter(|edge| those.binary_search(edge).is_err()).map(|&(a, b)| [a, b]).collect()
}

fn turn_to_start(found: &mut Sequence, name: &[usize], start: Option<usize>) -> Result<(), OrderError> {
    let (first, last) = (found.rows[0], found.rows[found.rows.len() - 1]);
    match start {
        _ if found.closed => rotate_to(&mut found.rows, start.unwrap_or(0)),
        Some(start) if name[start] == name[first] => {}
        Some(start) if name[start] == name[last] => found.rows.reverse(),
        Some(start) => return Err(OrderError::start_not_an_end(start, [first, last])),
        None if first > last => found.rows.reverse(),
        None => {}
    }
    Ok(())
}

/// What is known about an order before the searches are compared.
pub(crate) struct Examined {
    certificate: Certificate,
    certified: bool,
    pub(crate) doubts: Doubts,
}

impl Examined {
    /// Doubts about neighbourhoods give way to searches that found none, if the points are clean enough for a search to tell, and the
    /// doubts are about places where the curve crosses itself or nearly does: on noisy points, and where a curve runs back beside
    /// itself, all searches agree on the same wrong order too often.
    fn hear(&mut self, of_search: Vec<Doubt>) {
        if self.certificate.is_clean() && self.doubts.stretch <= LONGEST_DISPUTE {
            self.doubts.searchable = of_search;
        } else {
            self.doubts.searchable.extend(of_search);
        }
    }

    /// The order of the tree, with the verdict.
    pub(crate) fn answer(self, n: usize, recovery: Recovery, weight_stable: Option<bool>) -> Ordering {
        let mut doubts = self.doubts.searchable;
        doubts.extend(self.doubts.firm);
        doubts.extend(recovery.distinct.doubt.clone());
        // An order that nothing speaks against is one curve.
        let pieces = if doubts.is_empty() {
            Split::default()
        } else {
            split(&recovery.distinct.tree).with_equal_points(&recovery.distinct.groups)
        };
        let groups = recovery.distinct.groups;
        let mut group_of = vec![0; n];
        for (k, group) in groups.iter().enumerate() {
            group_of[group[0]] = k;
        }
        let order: Vec<usize> = recovery.rows.iter().flat_map(|&row| &groups[group_of[row]]).copied().collect();
        Ordering {
            n,
            components: pieces.curves,
            parts: Vec::new(),
            outliers: pieces.outliers,
            order,
            topology: if recovery.closed { Topology::Closed } else { Topology::Open },
            method: Method::Mst,
            verdict: match (doubts.is_empty(), self.certified) {
                (false, _) => Verdict::Ambiguous,
                (true, false) => Verdict::Plausible,
                (true, true) => Verdict::Certified,
            },
            weight_stable,
            metres_per_radian: None,
            duplicates: groups.into_iter().filter(|group| group.len() > 1).collect(),
            certificate: self.certificate,
            repaired: None,
            moved: Vec::new(),
            doubts,
        }
    }
}

fn examine_tree<M: Manifold>(manifold: &M, points: &[M::Point], recovery: &Recovery, branches: Vec<Doubt>) -> Examined {
    let tree = &recovery.distinct.tree;
    if !branches.is_empty() {
        let longest = tree.edge_weights().copied().fold(0.0, f64::max);
        let certificate = Certificate::of_no_curve(manifold, longest);
        let doubts = Doubts { searchable: branches, ..Doubts::default() };
        return Examined { certificate, certified: false, doubts };
    }
    examine_rows(manifold, points, recovery)
}

/// The order that `recovery` holds, however it was found.
pub(crate) fn examine_rows<M: Manifold>(manifold: &M, points: &[M::Point], recovery: &Recovery) -> Examined {
    let repeated = recovery.repeated(points.len());
    let curve = Curve::new(manifold, points, &recovery.rows, recovery.closed);
    examine_curve(&curve, &repeated, recovery.unsure_of_ends)
}

/// Equal points that stand together are one; where they stand apart, the curve passes there more than once.
fn examine_repaired<M: Manifold>(manifold: &M, points: &[M::Point], found: &Sequence, name: &[usize]) -> Examined {
    let rows = found.distinct_rows(name);
    let mut times = vec![0_usize; points.len()];
    rows.iter().for_each(|&row| times[name[row]] += 1);
    let repeated: Vec<bool> = name.iter().map(|&name| times[name] > 1).collect();
    examine_curve(&Curve::new(manifold, points, &rows, found.closed), &repeated, found.unsure_of_ends)
}

fn examine_curve<M: Manifold>(curve: &Curve<M>, repeated: &[bool], unsure_of_ends: bool) -> Examined {
    let _phase = debug_span!("certificate").entered();
    let gaps = curve.gaps();
    let found = sweep(curve, beyond_ends(&gaps));
    let certificate = Certificate::of_curve(curve, &gaps, &found);
    let holds = |certificate: &Certificate| certificate.conditions(curve.closed).iter().all(|c| c.holds);
    let certified = holds(&certificate);
    // Where a loop is asked for, independent points may have left any gap.
    let explained = look_independent(&gaps, curve.closed) && holds(&Certificate { closing_bound: None, ..certificate });
    let mut doubts = doubts::of_curve(curve, &gaps, &found, repeated, explained);
    doubts.firm.extend(doubts::of_few(curve, &certificate));
    if unsure_of_ends {
        doubts.firm.push(doubts::of_ends(curve, &gaps));
    }
    // Nothing is certified that a doubt had to be taken back for.
    let certified = certified && doubts.searchable.is_empty();
    Examined { certificate, certified, doubts }
}
