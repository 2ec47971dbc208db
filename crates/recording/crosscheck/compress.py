"""Rewrites a recording with the MCAP library, compressed: python compress.py RECORDING OUT zstd|lz4."""
import sys

from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer


def main(source, target, compression):
    schemas, channels = {}, {}
    with open(source, "rb") as recording, open(target, "wb") as out:
        reader = make_reader(recording)
        writer = Writer(out, compression=CompressionType[compression.upper()])
        writer.start(profile=reader.get_header().profile)
        for metadata in reader.iter_metadata():
            writer.add_metadata(metadata.name, metadata.metadata)
        for schema, channel, message in reader.iter_messages(log_time_order=False):
            if schema.id not in schemas:
                schemas[schema.id] = writer.register_schema(schema.name, schema.encoding, schema.data)
            if channel.id not in channels:
                encoding, known = channel.message_encoding, schemas[schema.id]
                channels[channel.id] = writer.register_channel(channel.topic, encoding, known, channel.metadata)
            at, utc = message.log_time, message.publish_time
            writer.add_message(channels[channel.id], at, message.data, utc, message.sequence)
        writer.finish()


if __name__ == "__main__":
    main(*sys.argv[1:])
