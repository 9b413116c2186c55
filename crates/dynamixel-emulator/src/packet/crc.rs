/// The CRC-16 of Protocol 2.0 over `bytes`, going on from `crc` (0 at a packet's first byte): polynomial 0x8005, most significant bit
/// first, nothing reflected or inverted. See [CRC calculation](https://emanual.robotis.com/docs/en/dxl/crc/).
#[must_use]
pub fn crc16(crc: u16, bytes: &[u8]) -> u16 {
    bytes.iter().fold(crc, |crc, byte| (crc << 8) ^ OF_BYTE[usize::from((crc >> 8) as u8 ^ byte)])
}

const POLYNOMIAL: u16 = 0x8005;

/// The CRC of every single byte.
const OF_BYTE: [u16; 256] = {
    let mut table = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        let mut crc = (byte as u16) << 8;
        let mut bit = 0;
        while bit < 8 {
            crc = if crc & 0x8000 == 0 { crc << 1 } else { (crc << 1) ^ POLYNOMIAL };
            bit += 1;
        }
        table[byte] = crc;
        byte += 1;
    }
    table
};
