#!/usr/bin/env python3
"""Opens the bag of a recorder that was killed, as others would, and says how many messages they find.

usage: open_killed_bag.py FOLDER

Prints one JSON object: {"rosbags": N, "mcap": N}.
"""

import json
import sys
from pathlib import Path

from mcap.stream_reader import StreamReader
from mcap.records import Chunk, Message
from mcap.exceptions import McapError
from rosbags.rosbag2 import Reader


def by_rosbags(folder):
    with Reader(folder) as reader:
        return sum(1 for _ in reader.messages())


def by_mcap(folder):
    """From the beginning on, as far as it goes: there is no index at the end."""
    count = 0
    for file in sorted(folder.glob("*.mcap")):
        with file.open("rb") as stream:
            try:
                for record in StreamReader(stream).records:
                    count += isinstance(record, Message)
            except (McapError, EOFError):
                pass
    return count


def main():
    folder = Path(sys.argv[1])
    print(json.dumps({"rosbags": by_rosbags(folder), "mcap": by_mcap(folder)}))


if __name__ == "__main__":
    main()
