"""ROBOTIS's own SDK as a master of a Dynamixel bus: one JSON list `[call, argument…]` a line in, one JSON value a line out.

    dynamixel_master.py PORT BAUD

An answer is {"value": …}, {"refused": number of the error} or {"failed": result code of the SDK}. Bytes are lists of integers.
`encode` needs no port: it gives the bytes of packets.
"""

import json
import sys

import dynamixel_sdk as sdk
import dynamixel_sdk.port_handler

# The SDK waits for an answer twice this long, in ms; its own 16 are few for a bus that is a thread of a busy machine.
dynamixel_sdk.port_handler.LATENCY_TIMER = 150

handler = sdk.PacketHandler(2.0)
INSTRUCTION_ERROR = 0x7F


def answer(result, error, value=None):
    if result != sdk.COMM_SUCCESS:
        return {"failed": result}
    return {"refused": error & INSTRUCTION_ERROR} if error & INSTRUCTION_ERROR else {"value": value}


def ping(port, servo):
    model, result, error = handler.ping(port, servo)
    return answer(result, error, model)


def scan(port):
    found, result = handler.broadcastPing(port)
    return answer(result, 0, sorted(found))


def read(port, servo, address, length):
    data, result, error = handler.readTxRx(port, servo, address, length)
    return answer(result, error, data)


def write(port, servo, address, data):
    return answer(*handler.writeTxRx(port, servo, address, len(data), data))


def reg_write(port, servo, address, data):
    return answer(*handler.regWriteTxRx(port, servo, address, len(data), data))


def action(port, servo):
    """The SDK does not wait for the answer of an action; here its parts do."""
    packet = [0] * 10
    packet[sdk.PKT_ID], packet[sdk.PKT_LENGTH_L], packet[sdk.PKT_INSTRUCTION] = servo, 3, sdk.INST_ACTION
    result = handler.txPacket(port, packet)
    if result != sdk.COMM_SUCCESS:
        return answer(result, 0)
    port.setPacketTimeout(11)
    status, result = handler.rxPacket(port, False)
    return answer(result, status[sdk.PKT_ERROR] if result == sdk.COMM_SUCCESS else 0)


def reboot(port, servo):
    return answer(*handler.reboot(port, servo))


def factory_reset_but_id_and_baud(port, servo):
    return answer(*handler.factoryReset(port, servo, 0x02))


def clear(port, servo):
    return answer(*handler.clearMultiTurn(port, servo))


def sync_read(port, servos, address, length, fast=False):
    group = sdk.GroupSyncRead(port, handler, address, length)
    for servo in servos:
        group.addParam(servo)
    result = group.fastSyncRead() if fast else group.txRxPacket()
    return answer(result, 0, [list(group.data_dict[servo]) for servo in servos])


def fast_sync_read(port, servos, address, length):
    return sync_read(port, servos, address, length, fast=True)


def sync_write(port, address, writes):
    group = sdk.GroupSyncWrite(port, handler, address, len(writes[0][1]))
    for servo, data in writes:
        group.addParam(servo, data)
    return answer(group.txPacket(), 0)


def bulk_read(port, reads, fast=False):
    group = sdk.GroupBulkRead(port, handler)
    for servo, address, length in reads:
        group.addParam(servo, address, length)
    result = group.fastBulkRead() if fast else group.txRxPacket()
    return answer(result, 0, [list(group.data_dict[servo][0]) for servo, _, _ in reads])


def fast_bulk_read(port, reads):
    return bulk_read(port, reads, fast=True)


def bulk_write(port, writes):
    group = sdk.GroupBulkWrite(port, handler)
    for servo, address, data in writes:
        group.addParam(servo, address, len(data), data)
    return answer(group.txPacket(), 0)


def encode(_port, packets):
    """Packets stuffed and with their CRC. `txPacket` of 4.1.0 drops what `addStuffing` returns, hence not by it."""
    return answer(sdk.COMM_SUCCESS, 0, [encoded(*packet) for packet in packets])


def encoded(servo, instruction, parameters):
    length = len(parameters) + 3
    head = [0xFF, 0xFF, 0xFD, 0, servo, length & 0xFF, length >> 8, instruction]
    packet = handler.addStuffing(head + parameters + [0, 0])
    crc = handler.updateCRC(0, packet, len(packet) - 2)
    packet[-2:] = [crc & 0xFF, crc >> 8]
    return bytes(packet).hex()


def main():
    port = None
    if len(sys.argv) == 3:
        port = sdk.PortHandler(sys.argv[1])
        if not (port.openPort() and port.setBaudRate(int(sys.argv[2]))):
            sys.exit(f"cannot open {sys.argv[1]} at {sys.argv[2]} baud")
    for line in sys.stdin:
        call, *arguments = json.loads(line)
        print(json.dumps(globals()[call](port, *arguments)), flush=True)


if __name__ == "__main__":
    main()
