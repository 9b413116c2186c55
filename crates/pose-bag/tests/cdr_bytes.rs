//! Bytes to messages: both byte orders, and bytes that are no message.
#![allow(clippy::unwrap_used)]

mod support;

use pose_bag::msg::{JointTrajectory, Path, PoseArray, PoseStamped};
use pose_bag::{CdrError, decode, encode};
use proptest::prelude::*;
use support::{array, poses, stamped};

/// A `PoseArray` in the frame "map" at 1 s + 2 ns with one pose, as the CDR standard lays it out.
fn hand_built(big_endian: bool) -> Vec<u8> {
    let u32 = |value: u32| if big_endian { value.to_be_bytes() } else { value.to_le_bytes() };
    let mut bytes = vec![0, u8::from(!big_endian), 0, 0];
    for value in [1, 2, 4] {
        bytes.extend(u32(value)); // seconds, nanoseconds, length of "map" with its zero
    }
    bytes.extend(b"map\0");
    bytes.extend(u32(1)); // poses
    bytes.extend([0; 4]); // up to the next multiple of eight
    for value in [0.5_f64, -1.25, 3.0, 0.1, 0.2, 0.3, 0.4] {
        bytes.extend(if big_endian { value.to_be_bytes() } else { value.to_le_bytes() });
    }
    bytes
}

#[test]
fn both_byte_orders() {
    for big_endian in [false, true] {
        let message: PoseArray = decode(&hand_built(big_endian)).unwrap();
        assert_eq!((message.header.stamp.sec, message.header.stamp.nanosec), (1, 2));
        assert_eq!(message.header.frame_id, "map");
        let [pose] = message.poses[..] else { panic!("one pose") };
        assert_eq!((pose.position.x, pose.position.y, pose.position.z), (0.5, -1.25, 3.0));
        let q = pose.orientation;
        assert_eq!((q.x, q.y, q.z, q.w), (0.1, 0.2, 0.3, 0.4));
    }
}

#[test]
fn encoding_is_the_standard_layout() {
    let message: PoseArray = decode(&hand_built(true)).unwrap();
    assert_eq!(encode(&message).unwrap(), hand_built(false));
}

#[test]
fn every_cut_is_an_error_and_padding_to_four_bytes_is_none() {
    let whole = hand_built(false);
    for len in 0..whole.len() {
        let error = decode::<PoseArray>(&whole[..len]).unwrap_err();
        let expected = if len < 4 { CdrError::NoEncapsulation { len } } else { malformed(len) };
        assert_eq!(error, expected);
    }
    for padding in 1..=3 {
        assert!(decode::<PoseArray>(&[whole.clone(), vec![0; padding]].concat()).is_ok());
    }
    let longer = [whole.clone(), vec![0; 4]].concat();
    let error = CdrError::TrailingBytes { len: longer.len(), used: whole.len() };
    assert_eq!(decode::<PoseArray>(&longer).unwrap_err(), error);
}

fn malformed(len: usize) -> CdrError {
    CdrError::Malformed { len, reason: "unexpected end of input".into() }
}

#[test]
fn claimed_lengths_beyond_the_bytes_are_refused() {
    let (string_length, pose_count) = (12, 20);
    for (offset, big_endian) in [string_length, pose_count].into_iter().flat_map(|o| [(o, true), (o, false)]) {
        let mut bytes = hand_built(big_endian);
        bytes[offset..offset + 4].fill(0xff); // 4,294,967,295
        assert_eq!(decode::<PoseArray>(&bytes).unwrap_err(), malformed(bytes.len()));
    }
}

#[test]
fn other_representations_are_refused() {
    let mut bytes = hand_built(false);
    bytes[1] = 7; // XCDR2, little endian: eight-byte numbers are aligned to four
    assert_eq!(decode::<PoseArray>(&bytes).unwrap_err(), CdrError::UnknownRepresentation { representation: 7 });
}

fn decode_as_everything(bytes: &[u8]) {
    let _ = decode::<PoseArray>(bytes);
    let _ = decode::<PoseStamped>(bytes);
    let _ = decode::<Path>(bytes);
    let _ = decode::<JointTrajectory>(bytes);
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: proptest::test_runner::RngSeed::Fixed(3), ..ProptestConfig::with_cases(2000) })]

    #[test]
    fn random_bytes_do_not_panic(endianness in 0_u8..2, body in prop::collection::vec(any::<u8>(), 0..300)) {
        decode_as_everything(&body);
        decode_as_everything(&[vec![0, endianness, 0, 0], body].concat());
    }

    #[test]
    fn damaged_messages_do_not_panic(at in 0_usize..200, byte: u8, cut in 0_usize..200) {
        for mut bytes in [encode(&array("base", &poses(3))).unwrap(), encode(&stamped("base", 5, &poses(1)[0])).unwrap()] {
            let at = at % bytes.len();
            bytes[at] = byte;
            decode_as_everything(&bytes);
            decode_as_everything(&bytes[..cut.min(bytes.len())]);
        }
    }
}
