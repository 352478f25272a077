"""LCM logs and the graph's types, for tests in Python."""
import importlib
import struct
import subprocess
import sys

SYNC = 0xEDA1DA01
HEADER = struct.Struct(">IQQII")


def generate_types(source, folder):
    """Makes Python decoders of all types in `folder` and lets them be imported."""
    files = sorted(str(file) for file in (source / "lcmtypes").rglob("*.lcm"))
    subprocess.run(["lcm-gen", "-p", "--ppath", str(folder), *files], check=True,
                   stdout=subprocess.DEVNULL)
    sys.path.insert(0, str(folder))


def type_named(name):
    """`clearway.status_t` -> its class."""
    module, _, short = name.rpartition(".")
    return getattr(importlib.import_module(f"{module}.{short}"), short)


def events(path):
    """(arrival_us, channel, bytes) of a log, also of one that is still being written."""
    data = path.read_bytes()
    at = 0
    while at + HEADER.size <= len(data):
        sync, _, utime, channel_bytes, num_bytes = HEADER.unpack_from(data, at)
        if sync != SYNC:
            raise ValueError(f"{path}: no event at byte {at}")
        at += HEADER.size
        end = at + channel_bytes + num_bytes
        if end > len(data):
            return
        yield utime, data[at:at + channel_bytes].decode(), data[at + channel_bytes:end]
        at = end


def messages(path, channel, type_name):
    """(arrival_us, message) of one channel."""
    decode = type_named(type_name).decode
    return [(utime, decode(data)) for utime, name, data in events(path) if name == channel]
