"""Prints what Rerun sees in an MCAP log, one JSON object for each entity and time: the components that its own importer
makes of the messages.

    python3 -m pip install rerun-sdk==0.41.0
    python3 tests/read_log_in_rerun.py mission.mcap
"""

import json
import sys

from rerun.chunk import McapReader

TIME = "message_log_time"

for chunk in McapReader(sys.argv[1]).stream():
    if chunk.is_static:  # schemas, channels and statistics of the file
        continue
    for row in chunk.to_record_batch().to_pylist():
        components = {name: value for name, value in row.items() if ":" in name and value is not None}
        line = {"entity": chunk.entity_path, "time": row[TIME].timestamp(), "components": components}
        print(json.dumps(line))
