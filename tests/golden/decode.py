"""Says what cantools makes of frames: decode.py DBC, a list of ID#HEX as JSON on stdin.

It prints the messages that the DBC has, and for each frame its values: raw, with their factor,
and by name; and the frames that cantools makes of those values again.
"""

import json
import sys

import cantools


def describe(message):
    return {
        "id": message.frame_id,
        "length": message.length,
        "sender": ", ".join(message.senders),
        "signals": {
            signal.name: {"unit": signal.unit or "", "choices": bool(signal.choices)}
            for signal in message.signals
        },
    }


def encode(message, values, **options):
    try:
        return f"{message.frame_id:03X}#{message.encode(values, **options).hex().upper()}"
    except (cantools.Error, OverflowError) as error:
        # A test that expects the frame back sees this instead.
        return str(error)


def decode(database, text):
    identifier, data = text.split("#")
    message = database.get_message_by_frame_id(int(identifier, 16))
    data = bytes.fromhex(data)
    raw = message.decode(data, scaling=False, decode_choices=False)
    scaled = message.decode(data, decode_choices=False)
    # As text, which reads back exactly whoever parses it.
    written = {name: str(value) for name, value in scaled.items()}
    names = {
        name: str(value)
        for name, value in message.decode(data).items()
        if not isinstance(value, (int, float))
    }
    return {
        "message": message.name,
        "raw": raw,
        "scaled": written,
        "names": names,
        "from_raw": encode(message, raw, scaling=False),
        # Not always the frame again: 56 bits do not fit a float.
        "from_scaled": encode(message, scaled),
    }


database = cantools.database.load_file(sys.argv[1], strict=True)
frames = json.load(sys.stdin)
json.dump(
    {
        "messages": {message.name: describe(message) for message in database.messages},
        "frames": [decode(database, frame) for frame in frames],
    },
    sys.stdout,
)
