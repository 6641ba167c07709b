"""Prints the messages of an MCAP log, one JSON object a line: read with the format's own Python library, by the
schemas in the file alone.

    python3 -m pip install mcap-protobuf-support==0.6.0
    python3 tests/read_log.py mission.mcap
"""

import json
import sys

from google.protobuf.json_format import MessageToDict
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

with open(sys.argv[1], "rb") as file:
    reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
    for schema, channel, message, decoded in reader.iter_decoded_messages():
        fields = MessageToDict(
            decoded, preserving_proto_field_name=True, always_print_fields_with_no_presence=True
        )
        line = {"schema": schema.name, "topic": channel.topic, "time": message.log_time, "message": fields}
        print(json.dumps(line))
