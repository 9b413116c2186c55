//! From a tree to a sequence.

use petgraph::graph::NodeIndex;
use petgraph::visit::EdgeRef;

use crate::spanning_tree::Tree;

/// No node.
const NOBODY: u32 = u32::MAX;

/// Whether no node has more than two neighbours.
pub(crate) fn is_path(tree: &Tree) -> bool {
    neighbours_on_path(tree).is_some()
}

/// Both neighbours of every node, or one and nobody; `None` where the tree branches. Of a million nodes they fit the processor's
/// caches, as the tree does not.
fn neighbours_on_path(tree: &Tree) -> Option<Vec<[u32; 2]>> {
    let mut neighbours = vec![[NOBODY; 2]; tree.node_count()];
    for edge in tree.raw_edges() {
        let ends = [edge.source().index(), edge.target().index()];
        for [node, other] in [ends, [ends[1], ends[0]]] {
            *neighbours[node].iter_mut().find(|known| **known == NOBODY)? = other as u32;
        }
    }
    Some(neighbours)
}

fn follow(neighbours: &[[u32; 2]], end: u32) -> Vec<NodeIndex> {
    let (mut before, mut here) = (NOBODY, end);
    let mut sequence = Vec::with_capacity(neighbours.len());
    while here != NOBODY {
        sequence.push(NodeIndex::new(here as usize));
        let [a, b] = neighbours[here as usize];
        (before, here) = (here, if a == before { b } else { a });
    }
    sequence
}

/// Distance along the tree from `root` to every node, with each node's parent, in an order in which parents come first.
fn spread(tree: &Tree, root: NodeIndex) -> (Vec<f64>, Vec<(NodeIndex, NodeIndex)>) {
    let mut distance = vec![0.0; tree.node_count()];
    let mut parents = Vec::with_capacity(tree.node_count());
    let mut stack = vec![(root, root)];
    while let Some((node, parent)) = stack.pop() {
        parents.push((node, parent));
        for edge in tree.edges(node).filter(|e| e.target() != parent) {
            distance[edge.target().index()] = distance[node.index()] + edge.weight();
            stack.push((edge.target(), node));
        }
    }
    (distance, parents)
}

fn farthest(distance: &[f64]) -> NodeIndex {
    let best = (0..distance.len()).reduce(|a, b| if distance[b] > distance[a] { b } else { a });
    NodeIndex::new(best.unwrap_or(0))
}

/// One end of the longest path in the tree. If the tree is a path, that is the first of its ends.
pub(crate) fn far_end(tree: &Tree) -> NodeIndex {
    if let Some(neighbours) = neighbours_on_path(tree) {
        return NodeIndex::new(neighbours.iter().position(|[_, second]| *second == NOBODY).unwrap_or(0));
    }
    farthest(&spread(tree, NodeIndex::new(0)).0)
}

/// Every node once, from `root` to the node farthest from it: a walk in depth-first order that takes side branches before it
/// goes on, the shallowest first. On a path that starts at `root` this is the path.
pub(crate) fn walk(tree: &Tree, root: NodeIndex) -> Vec<NodeIndex> {
    if let Some(neighbours) = neighbours_on_path(tree).filter(|all| all[root.index()][1] == NOBODY) {
        return follow(&neighbours, root.index() as u32);
    }
    let (distance, parents) = spread(tree, root);
    // How far the subtree below each node reaches from the root.
    let mut extent = distance;
    for &(node, parent) in parents.iter().rev() {
        extent[parent.index()] = extent[parent.index()].max(extent[node.index()]);
    }
    let mut sequence = Vec::with_capacity(tree.node_count());
    let mut stack = vec![(root, root)];
    while let Some((node, parent)) = stack.pop() {
        sequence.push(node);
        let mut children: Vec<_> = tree.neighbors(node).filter(|&child| child != parent).collect();
        children.sort_by(|a, b| extent[b.index()].total_cmp(&extent[a.index()]).then(b.cmp(a)));
        stack.extend(children.into_iter().map(|child| (child, node)));
    }
    sequence
}
