//! Any bytes as a message of every type: an error, or a message that has the same bytes again but for padding and byte order.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pose_bag::msg::{
    JointState, JointTrajectory, MarkerArray, Message, Odometry, Path, PoseArray, PoseStamped,
    PoseWithCovarianceStamped, Text, TfMessage,
};
use pose_bag::{decode, encode};

fn check<M: Message>(bytes: &[u8]) {
    let Ok(message) = decode::<M>(bytes) else { return };
    let encoded = encode(&message).expect("what was decoded has a form");
    // NaN is not equal to itself; its bytes are.
    let again = encode(&decode::<M>(&encoded).expect("its own form")).expect("a form");
    assert_eq!(encoded, again);
}

fuzz_target!(|bytes: &[u8]| {
    check::<PoseArray>(bytes);
    check::<PoseStamped>(bytes);
    check::<PoseWithCovarianceStamped>(bytes);
    check::<Odometry>(bytes);
    check::<Path>(bytes);
    check::<TfMessage>(bytes);
    check::<JointState>(bytes);
    check::<JointTrajectory>(bytes);
    check::<MarkerArray>(bytes);
    check::<Text>(bytes);
});
