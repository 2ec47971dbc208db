"""Checks our NMEA codec against pynmea2 in both directions: `pynmea2_check.py path/to/peer` (the example of this crate).

1. pynmea2 reads our sentences and finds the same values.
2. We read the sentences that pynmea2 renders from those values, and sentences assembled here.
"""

import random
import subprocess
import sys

import pynmea2

# The representation of our values on the wire.
MODES = "Standby Thruster Heading Speed StationKeep RiverNav Waypoint Autopilot CompassCalibration GoToErp Depth " \
    "GravityVector FileDownload BootLoader"
WORDS = {
    **dict(zip(MODES.split(), "LTCGRNWI3HDSF!")),
    "Primary": "1", "Secondary": "2", "PrimaryBackup": "3", "Rc": "5", "ObstacleAvoidance": "6",
    "None": "",
}
# Our values that pynmea2 lacks, and parts of others.
OURS = {"", "talker", "at", "with_mode", "heave_m", "year", "month", "day"}


def signed(size, letter):
    return None if size in ("", None) else float(size) * (-1.0 if letter == "W" else 1.0)


def time_ms(time):
    if not time:
        return None
    return ((time.hour * 60 + time.minute) * 60 + time.second) * 1e3 + time.microsecond / 1e3


def place(msg):
    # Through the class, because pynmea2's WPL has coordinates but lacks this mixin.
    fix = pynmea2.nmea_utils.LatLonFix
    return {
        "lat_deg": fix.latitude.fget(msg) if msg.lat else None, "lon_deg": fix.longitude.fget(msg) if msg.lon else None
    }


def date_text(date):
    return date.isoformat() if date else None


def proprietary(msg):
    """The values of a PSEAx: pynmea2 has the letter and the fields, but no names."""
    kind, *fields = msg.data
    names = {
        "C": "mode heading_deg thrust difference words",
        "A": "pitch_deg roll_deg heading_deg - box_c accel_ahead_g accel_starboard_g accel_down_g yaw_rate_deg_s",
        "B": "volts charge amps celsius charge_used reset_time reset_date port_volts starboard_volts system_amps "
             "port_amps starboard_amps port_bilge_amps starboard_bilge_amps hours",
        "D": "mode heading_deg thrust difference words transmission sent_to operator",
        "G": "code",
        "R": "- - throttle_pct - -",
    }[kind].split()
    assert len(fields) == len(names), (len(fields), msg)
    return {name: text for name, text in zip(names, fields) if name != "-"}


READERS = {
    "GGA": lambda m: {
        **place(m), "time": time_ms(m.timestamp), "quality": m.gps_qual, "satellites": m.num_sats,
        "hdop": m.horizontal_dil, "altitude_m": m.altitude, "geoid_m": m.geo_sep,
    },
    "RMC": lambda m: {
        **place(m), "time": time_ms(m.timestamp), "valid": m.status == "A", "speed_kn": m.spd_over_grnd,
        "course_deg": m.true_course, "date": date_text(m.datestamp),
    },
    "VTG": lambda m: {
        "course_true_deg": m.true_track, "course_magnetic_deg": m.mag_track, "speed_kn": m.spd_over_grnd_kts,
        "speed_km_h": m.spd_over_grnd_kmph,
    },
    "HDT": lambda m: {"heading_deg": m.heading},
    "HDG": lambda m: {
        "heading_deg": m.heading, "deviation_deg": signed(m.deviation, m.dev_dir),
        "variation_deg": signed(m.variation, m.var_dir),
    },
    "ZDA": lambda m: {"time": time_ms(m.timestamp), "date": date_text(m.datestamp) if m.day else None},
    "WPL": lambda m: {**place(m), "index": m.waypoint_id},
}

# Half a unit in the last digit that we write.
TOLERANCE = {"lat_deg": 5.01e-5 / 60, "lon_deg": 5.01e-5 / 60, "time": 0.001}
HUNDREDTHS = {
    "hdop", "speed_kn", "speed_km_h", "accel_ahead_g", "accel_starboard_g", "accel_down_g", "yaw_rate_deg_s",
}
WHOLES = {"thrust", "difference", "charge", "charge_used", "hours", "throttle_pct"}
TEXTS = {"mode", "words", "code", "date", "transmission", "reset_time", "reset_date"}


def tolerance(name, values):
    if name in WHOLES or name == "heading_deg" and values.get("mode") == "T":
        return 0.501
    return TOLERANCE.get(name, 0.00501 if name in HUNDREDTHS else 0.0501)


def values_of(msg):
    if isinstance(msg, pynmea2.ProprietarySentence):
        return proprietary(msg)
    return READERS[msg.sentence_type](msg)


def compare(ours, theirs, wire):
    """Fails unless both have the same values; `ours` are strings."""
    assert ours.keys() == theirs.keys(), (sorted(ours), sorted(theirs), wire)
    for name, text in ours.items():
        value = theirs[name]
        if name in TEXTS:
            same = text == (value or "")
        elif name == "valid":
            same = text == str(value).lower()
        elif text == "" or value in ("", None):
            same = text == "" and value in ("", None)
        else:
            off = abs(float(text) - float(value))
            same = min(off, abs(off - 360.0)) <= tolerance(name, ours)
        assert same, f"{name} is {text!r} here and {value!r} there: {wire}"


def pairs(text):
    """The values of one of our sentences, as on the wire."""
    known = dict(pair.split("=", 1) for pair in text.split("\t"))
    if known.get("at") == "None":
        known["lat_deg"] = known["lon_deg"] = "None"
    if known.get("date") == "Date":
        known["date"] = f"{int(known['year']):04d}-{int(known['month']):02d}-{int(known['day']):02d}"
    return {name: WORDS.get(value, value.strip("'\"")) for name, value in known.items() if name not in OURS}


def read_back(peer, wires):
    answers = subprocess.run(
        [peer, "read"], input="".join(wire + "\n" for wire in wires), capture_output=True, text=True, check=True
    ).stdout.splitlines()
    assert len(answers) == len(wires), (len(answers), len(wires))
    return answers


def foreign(dice):
    """Sentences that pynmea2 renders from values, with field widths other than ours."""
    def number(low, high, places):
        return "" if dice.random() < 0.1 else f"{dice.uniform(low, high):.{places}f}"

    lat = f"{dice.randrange(90):02d}{dice.uniform(0, 59.99):09.6f}"
    lon = f"{dice.randrange(180):03d}{dice.uniform(0, 59.99):08.5f}"
    where = (lat, dice.choice("NS"), lon, dice.choice("EW"))
    time = f"{dice.randrange(24):02d}{dice.randrange(60):02d}{dice.randrange(60):02d}" + dice.choice(["", ".5", ".250"])
    date = f"{dice.randint(1, 28):02d}{dice.randint(1, 12):02d}{dice.randint(0, 60):02d}"
    yield pynmea2.GGA("GN", "GGA", (time, *where, "4", "08", number(0, 9, 1), number(-9, 99, 3), "M", number(-50, 50, 2), "M", "1.2", "0031"))
    yield pynmea2.RMC("GP", "RMC", (time, dice.choice("AV"), *where, number(0, 9, 3), number(0, 359, 2), date, "", "", "A"))
    yield pynmea2.VTG("GP", "VTG", (number(0, 359, 2), "T", number(0, 359, 0), "M", number(0, 9, 3), "N", number(0, 9, 3), "K"))
    yield pynmea2.HDT("HE", "HDT", (number(0, 359, 3), "T"))
    yield pynmea2.HDG("HC", "HDG", (number(0, 359, 2), f"{dice.uniform(0, 9):.1f}", "E", f"{dice.uniform(0, 9):.2f}", "W"))
    yield pynmea2.ZDA("GP", "ZDA", (time, f"{dice.randint(1, 28):02d}", f"{dice.randint(1, 12):02d}", str(dice.randint(2000, 2060)), "00", "00"))
    yield pynmea2.WPL("OI", "WPL", (*where, str(dice.randrange(65536))))


def main(peer):
    written = subprocess.run([peer, "write"], capture_output=True, text=True, check=True).stdout.splitlines()
    kinds, rendered = {}, []
    for line in written:
        wire, text = line.split("\t", 1)
        msg = pynmea2.parse(wire, check=True)
        compare(pairs(text), values_of(msg), wire)
        assert str(msg) == wire, (str(msg), wire)
        rendered.append((str(msg), values_of(msg)))
        kind = wire[1:6] if wire.startswith("$P") else wire[3:6]
        kinds[kind] = kinds.get(kind, 0) + 1
    assert len(kinds) == 13, sorted(kinds)
    print(f"pynmea2 reads our sentences: {sum(kinds.values())} sentences of {len(kinds)} kinds")

    seed = 20261120
    dice = random.Random(seed)
    for _ in range(200):
        rendered.extend((str(msg), values_of(pynmea2.parse(str(msg), check=True))) for msg in foreign(dice))
    for (wire, values), answer in zip(rendered, read_back(peer, [wire for wire, _ in rendered])):
        assert "=" in answer, f"{wire}: {answer}"
        compare(pairs(answer), values, wire)
    print(f"we read pynmea2's sentences: {len(rendered)} sentences (seed {seed})")


if __name__ == "__main__":
    main(sys.argv[1])
