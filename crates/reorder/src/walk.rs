//! From a tree to a sequence.

use petgraph::graph::NodeIndex;
use petgraph::visit::EdgeRef;

use crate::spanning_tree::Tree;

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

/// One end of the longest path in the tree. If the tree is a path, that is one of its ends.
pub(crate) fn far_end(tree: &Tree) -> NodeIndex {
    farthest(&spread(tree, NodeIndex::new(0)).0)
}

/// Every node once, from `root` to the node farthest from it: a walk in depth-first order that takes side branches before it
/// goes on, the shallowest first. On a path that starts at `root` this is the path.
pub(crate) fn walk(tree: &Tree, root: NodeIndex) -> Vec<NodeIndex> {
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
