"""Copies Ethernet frames between two interfaces, late and with losses: a long link, where the kernel has no netem.

    relay.py INTERFACE INTERFACE --delay-ms D --loss P

Runs until it is killed. Each way has the delay and the probability of a loss.
"""

import argparse
import heapq
import itertools
import random
import select
import socket
import time

ETH_P_ALL = 3
# A frame that this machine sent itself, seen again on its way out.
PACKET_OUTGOING = 4
BUFFER_BYTES = 8 << 20


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("interfaces", nargs=2)
    parser.add_argument("--delay-ms", type=float, required=True)
    parser.add_argument("--loss", type=float, required=True)
    parser.add_argument("--seed", type=int, default=1)
    return parser.parse_args()


def attach(interface):
    end = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(ETH_P_ALL))
    end.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, BUFFER_BYTES)
    end.bind((interface, 0))
    end.setblocking(False)
    return end


def frames(end):
    """What has arrived. A link that is down says so once, and then nothing."""
    while True:
        try:
            frame, (_, _, kind, *_) = end.recvfrom(1 << 16)
        except OSError:
            return
        if kind != PACKET_OUTGOING:
            yield frame


def main():
    options = arguments()
    chance = random.Random(options.seed)
    one, other = map(attach, options.interfaces)
    opposite, under_way, number = {one: other, other: one}, [], itertools.count()
    while True:
        wait_s = max(0.0, under_way[0][0] - time.monotonic()) if under_way else None
        ready, _, _ = select.select(opposite, [], [], wait_s)
        now = time.monotonic()
        for end in ready:
            for frame in frames(end):
                if chance.random() >= options.loss:
                    heapq.heappush(under_way, (now + options.delay_ms / 1e3, next(number), opposite[end], frame))
        while under_way and under_way[0][0] <= time.monotonic():
            *_, end, frame = heapq.heappop(under_way)
            try:
                end.send(frame)
            except OSError:  # the link is down
                pass


if __name__ == "__main__":
    main()
