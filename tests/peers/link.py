"""Two hosts as network namespaces, with a long link between them.

Everything here runs in a namespace of its own (`unshare --net`), which is the place between the hosts. They have a veth pair each, the
other ends of which are here, and `relay.py` copies between these.
"""

import ctypes
import fcntl
import os
import socket
import struct
import subprocess
import sys
import time
from pathlib import Path

PEERS = Path(__file__).parent
SIOCETHTOOL, ETHTOOL_STXCSUM = 0x8946, 0x17


class Host:
    """A network namespace that is there as long as its first process."""

    def __init__(self, name, address):
        self.name, self.here, self.inside = name, f"to_{name}", f"eth_{name}"
        self.first = subprocess.Popen(["unshare", "--net", "sleep", "infinity"])
        own = os.readlink("/proc/self/ns/net")
        while os.readlink(f"/proc/{self.first.pid}/ns/net") == own:
            time.sleep(0.01)
        ip("link", "add", self.here, "type", "veth", "peer", "name", self.inside, "netns", str(self.first.pid))
        ip("link", "set", self.here, "up")
        self.run("ip", "link", "set", "lo", "up")
        self.run("ip", "addr", "add", f"{address}/24", "dev", self.inside)
        self.run("ip", "link", "set", self.inside, "up")
        self.run("ip", "route", "add", "224.0.0.0/4", "dev", self.inside)
        self.run(sys.executable, __file__, self.inside)

    def command(self, *words):
        return ["nsenter", f"--net=/proc/{self.first.pid}/ns/net", *words]

    def run(self, *words):
        subprocess.run(self.command(*words), check=True)

    def start(self, *words, **options):
        return subprocess.Popen(self.command(*words), **options)


class Link:
    """Two hosts, `a` and `b`, that hear each other late and not always, until the link is cut."""

    def __init__(self, delay_ms, loss):
        self.a, self.b = Host("a", "10.77.0.1"), Host("b", "10.77.0.2")
        options = ["--delay-ms", str(delay_ms), "--loss", str(loss)]
        self.relay = subprocess.Popen([sys.executable, PEERS / "relay.py", self.a.here, self.b.here, *options])

    def cut(self):
        ip("link", "set", self.a.here, "down")

    def restore(self):
        ip("link", "set", self.a.here, "up")

    def close(self):
        for process in (self.relay, self.a.first, self.b.first):
            process.kill()
            process.wait()


def ip(*words):
    subprocess.run(["ip", *words], check=True)


def without_offload(interface):
    """The kernel leaves checksums to hardware, and here is none: a relay would copy frames without."""
    value = ctypes.create_string_buffer(struct.pack("II", ETHTOOL_STXCSUM, 0))
    request = struct.pack("16sQ16x", interface.encode(), ctypes.addressof(value))
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        fcntl.ioctl(any_socket, SIOCETHTOOL, request)


if __name__ == "__main__":
    without_offload(sys.argv[1])
