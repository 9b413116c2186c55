//! A cyclic sequence that is changed by reversals, each of which can be taken back.

/// Every node once, in a circle. Reversing a stretch or the rest gives the same circle, so that the shorter one is reversed.
pub(super) struct Ring {
    nodes: Vec<usize>,
    position: Vec<usize>,
    /// First position and length of what was reversed since the last [`Ring::keep`].
    journal: Vec<(usize, usize)>,
}

impl Ring {
    pub(super) fn new(nodes: Vec<usize>) -> Self {
        let mut position = vec![0; nodes.len()];
        for (k, &v) in nodes.iter().enumerate() {
            position[v] = k;
        }
        Self { nodes, position, journal: Vec::new() }
    }
    pub(super) fn len(&self) -> usize {
        self.nodes.len()
    }
    pub(super) fn into_nodes(self) -> Vec<usize> {
        self.nodes
    }
    #[cfg(test)]
    pub(super) fn nodes(&self) -> &[usize] {
        &self.nodes
    }
    pub(super) fn node(&self, position: usize) -> usize {
        self.nodes[position % self.nodes.len()]
    }
    pub(super) fn position(&self, v: usize) -> usize {
        self.position[v]
    }
    pub(super) fn next(&self, v: usize) -> usize {
        let k = self.position[v] + 1;
        self.nodes[if k == self.nodes.len() { 0 } else { k }]
    }
    pub(super) fn previous(&self, v: usize) -> usize {
        let k = self.position[v];
        self.nodes[if k == 0 { self.nodes.len() - 1 } else { k - 1 }]
    }
    /// The neighbour of v, forward or backward.
    pub(super) fn step(&self, v: usize, forward: bool) -> usize {
        if forward { self.next(v) } else { self.previous(v) }
    }
    /// How many nodes a walk from v to w passes, both included.
    pub(super) fn count(&self, v: usize, w: usize, forward: bool) -> usize {
        let (from, to) = if forward { (v, w) } else { (w, v) };
        let (from, to) = (self.position[from], self.position[to]);
        if to >= from { to - from + 1 } else { to + self.nodes.len() - from + 1 }
    }
    /// Replaces the edges ab and cd by ac and bd, where b follows a as d follows c.
    pub(super) fn exchange(&mut self, a: usize, b: usize, c: usize, d: usize) {
        let (first, last) = if self.next(a) == b { (b, c) } else { (a, d) };
        let (from, count) = (self.position[first], self.count(first, last, true));
        let rest = self.nodes.len() - count;
        let (from, count) = if count <= rest { (from, count) } else { ((from + count) % self.nodes.len(), rest) };
        self.reverse(from, count);
        self.journal.push((from, count));
    }
    /// Brings the stretch m₁…m₂ before the stretch s₁…s₂, where p s₁…s₂ m₁…m₂ y is a walk in either direction; `turned` reverses
    /// s₁…s₂ on the way.
    pub(super) fn swap(&mut self, [p, s1, s2, m1, m2, y]: [usize; 6], turned: bool) {
        self.exchange(p, s1, m2, y);
        self.exchange(p, m2, m1, s2);
        if !turned {
            self.exchange(m2, s2, s1, y);
        }
    }
    /// Puts the stretches s₁…s₂ and t₁…t₂ in each other's place, where p s₁…s₂ q…x t₁…t₂ y is a walk in either direction.
    pub(super) fn trade(&mut self, [p, s1, s2, q, x, t1, t2, y]: [usize; 8]) {
        self.exchange(p, s1, t2, y);
        self.exchange(p, t2, t1, x);
        self.exchange(t2, x, q, s2);
        self.exchange(x, s2, s1, y);
    }
    fn reverse(&mut self, from: usize, count: usize) {
        let n = self.nodes.len();
        let (mut i, mut j) = (from, (from + count + n - 1) % n);
        for _ in 0..count / 2 {
            self.nodes.swap(i, j);
            self.position[self.nodes[i]] = i;
            self.position[self.nodes[j]] = j;
            i = if i + 1 == n { 0 } else { i + 1 };
            j = if j == 0 { n - 1 } else { j - 1 };
        }
    }
    /// Forgets how the circle came about.
    pub(super) fn keep(&mut self) {
        self.journal.clear();
    }
    /// Takes back everything since the last [`Ring::keep`].
    pub(super) fn take_back(&mut self) {
        while let Some((from, count)) = self.journal.pop() {
            self.reverse(from, count);
        }
    }
}
