/// What would be a header inside of a packet.
const PATTERN: [u8; 3] = [0xFF, 0xFF, 0xFD];

/// Instruction and parameters as they go on the wire: another FD follows every FF FF FD, so that none of them looks like a header.
#[must_use]
pub fn stuff(body: &[u8]) -> Vec<u8> {
    let mut stuffed = Vec::with_capacity(body.len());
    for (i, byte) in body.iter().enumerate() {
        stuffed.push(*byte);
        if body[..=i].ends_with(&PATTERN) {
            stuffed.push(0xFD);
        }
    }
    stuffed
}

/// Takes out what [`stuff`] put in.
#[must_use]
pub fn unstuff(stuffed: &[u8]) -> Vec<u8> {
    let mut body = Vec::with_capacity(stuffed.len());
    let mut after_pattern = false;
    for byte in stuffed {
        if after_pattern && *byte == 0xFD {
            after_pattern = false;
            continue;
        }
        body.push(*byte);
        after_pattern = body.ends_with(&PATTERN);
    }
    body
}
