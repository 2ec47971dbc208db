"""The emulated link and the figures, without root."""

import math
import struct
import unittest

from bad_link import Quality, Scheduler, hosts_of, summary
from boat_side import modes_in, proof_of
from figures import HEADING, WIDTH, Stop, Tally, quantile, round_trips, table
from link_check import checksum, echo_request, problem_of
from priority import stall_in
from rig import stopped_line


def arrivals(scheduler, now_s):
    return [(round(due_s, 9), target, packet) for due_s, target, packet in scheduler.arrivals(now_s)]


class SchedulerTest(unittest.TestCase):
    def test_packets_arrive_after_the_delay_in_the_order_in_which_they_were_sent(self):
        scheduler = Scheduler(Quality(delay_s=0.05), seed=1)
        for number in range(3):
            self.assertEqual(scheduler.send(1.0 + 0.001 * (number // 2), "a", "b", bytes([number])), "sent")
        self.assertEqual(scheduler.due_at_s(), 1.05)
        self.assertEqual(arrivals(scheduler, 1.0499), [])
        self.assertEqual(arrivals(scheduler, 1.0505), [(1.05, "b", b"\0"), (1.05, "b", b"\1")])
        self.assertEqual(arrivals(scheduler, 2.0), [(1.051, "b", b"\2")])
        self.assertIsNone(scheduler.due_at_s())

    def test_as_many_are_lost_as_was_asked_and_a_seed_loses_the_same_again(self):
        def fates(seed):
            scheduler = Scheduler(Quality(loss=0.05), seed)
            return [scheduler.send(0.0, "a", "b", b"") for _ in range(20_000)]

        # Standard deviation: 31.
        self.assertAlmostEqual(fates(1).count("lost"), 1000, delta=150)
        self.assertEqual(fates(1), fates(1))
        self.assertNotEqual(fates(1), fates(2))

    def test_a_cut_takes_what_is_in_flight_and_nothing_of_other_pairs(self):
        scheduler = Scheduler(Quality(delay_s=0.05), seed=1)
        scheduler.send(0.0, "a", "b", b"in flight")
        scheduler.send(0.0, "a", "c", b"elsewhere")
        scheduler.cut("b", "a")
        self.assertEqual(scheduler.send(0.01, "a", "b", b""), "cut")
        self.assertEqual(scheduler.send(0.01, "b", "a", b""), "cut")
        self.assertEqual(arrivals(scheduler, 1.0), [(0.05, "c", b"elsewhere")])
        scheduler.restore()
        self.assertEqual(scheduler.send(1.0, "a", "b", b"again"), "sent")
        self.assertEqual(arrivals(scheduler, 2.0), [(1.05, "b", b"again")])

    def test_a_rate_limit_queues_and_drops_what_finds_no_room(self):
        scheduler = Scheduler(Quality(delay_s=1.0, rate_bytes_s=1000, queue_bytes=250), seed=1)
        packet = bytes(100)
        self.assertEqual([scheduler.send(0.0, "a", "b", packet) for _ in range(3)], ["sent", "sent", "full"])
        # The other direction has its own queue, and space becomes free over time.
        self.assertEqual(scheduler.send(0.0, "b", "a", packet), "sent")
        self.assertEqual(scheduler.send(0.1, "a", "b", packet), "sent")
        due_s = [due_s for due_s, target, _ in arrivals(scheduler, 9.0) if target == "b"]
        self.assertEqual(due_s, [1.1, 1.2, 1.3])

    def test_hosts_and_packets_are_read(self):
        self.assertEqual(hosts_of(["a=squall-a:10.77.0.1"]), {"a": ("squall-a", "10.77.0.1")})
        for wrong in ("a", "a=squall-a", "a=squall-a:10.77.0"):
            with self.assertRaises(ValueError):
                hosts_of([wrong])
        head = bytes([0x45]) + bytes(8) + bytes([6]) + bytes(10)
        tcp = struct.pack("!HHIIBB", 1, 2, 3, 4, 5 << 4, 0x12) + bytes(6)
        self.assertEqual(summary(head + tcp + b"xy"), "tcp 1 > 2 [SA] seq 3 ack 4, 2 B")
        self.assertEqual(summary(head[:9] + bytes([17]) + bytes(10) + struct.pack("!HHHH", 1, 2, 9, 0) + b"x"), "udp 1 > 2, 1 B")
        self.assertEqual(summary(head[:9] + bytes([1]) + bytes(10) + b"12345678"), "protocol 1, 8 B")


class FigureTest(unittest.TestCase):
    def test_quantiles_are_values_that_were_measured(self):
        values = [float(value) for value in range(100, 0, -1)]
        self.assertEqual([quantile(values, share) for share in (0.0, 0.5, 0.99, 1.0)], [1.0, 50.0, 99.0, 100.0])
        self.assertEqual(quantile([7.0], 0.99), 7.0)
        self.assertIsNone(quantile([], 0.5))
        self.assertEqual(quantile([1.0, math.inf], 1.0), math.inf)

    def test_one_late_unseen_or_wrongly_shown_stop_fails_a_condition(self):
        good = Stop([60.0, 50.0], [110.0, 100.0])
        for stops, passed in (
            ([good], True),
            ([good, Stop([250.0], [300.0])], True),
            ([good, Stop([60.0, 250.1], [300.0, 300.0])], False),
            ([good, Stop([math.inf], [math.inf])], False),
            ([good, Stop([60.0, 60.0], [110.0, math.inf])], False),
            # The second boat is shown before it has stopped, although the first is later.
            ([good, Stop([60.0, 60.0], [110.0, 59.0])], False),
            ([], False),
        ):
            self.assertEqual(Tally(250.0, stops).passed(), passed, stops)
        early = Stop([60.0], [59.0])
        for false_share, passed in ((0.0, False), (0.01, True)):
            self.assertEqual(Tally(250.0, [good, early], false_share=false_share).passed(), passed, false_share)
        self.assertFalse(Tally(250.0, [early, early], false_share=0.01).passed())
        tally = Tally(250.0, [good, Stop([60.0], [59.0]), Stop([math.inf], [math.inf])])
        self.assertEqual((tally.in_time(), tally.shown(), tally.false()), (2, 2, 1))

    def test_the_widest_table_is_as_wide_as_a_terminal(self):
        tally = Tally(250.0, [Stop([12345.6], [1.0])] * 1000, 12345.6)
        rows = [tally.row("stopped-sim"), Tally(250.0, [Stop([1.0], [2.0])]).row("clean"), Tally(1.0).row("x")]
        text = table(HEADING, rows)
        self.assertLessEqual(max(map(len, text.splitlines())), WIDTH)
        self.assertEqual(text.splitlines()[2].split(), ["clean", "1/1", "1.0", "1.0", "1.0", "1", "0", "0.0"])

    def test_round_trips_do_not_count_the_start_of_the_program(self):
        self.assertEqual(round_trips(470.0, 20.0, 50.0), 4.5)
        self.assertIsNone(round_trips(20.0, 20.0, 0.0))


class WireTest(unittest.TestCase):
    def test_commands_are_found_however_their_bytes_are_cut(self):
        text = b"$PSEAC,L,0,0,0,*75\r\n$PSEAD,x\r\n$PSEAC,G,,1.0,0,*75\r\n$PSE"
        want = [("L", "$PSEAC,L,0,0,0,*75"), ("G", "$PSEAC,G,,1.0,0,*75")]
        for cut in range(len(text)):
            first, rest = modes_in(text[:cut])
            second, rest = modes_in(rest + text[cut:])
            self.assertEqual((first + second, rest), (want, b"$PSE"), cut)

    def test_a_proof_is_the_mac_of_lengths_and_parts(self):
        # By openssl: the parts "c", "gateway control port" and "{}", each after its length, under a token of zeros.
        self.assertEqual(proof_of("00" * 32, "c", b"{}"), "3cd85603d90a6d2be62317b0bd4727d3b50edaa437ac3fcacb1ac48c8d3edfd8")

    def test_the_console_shows_a_stop_of_the_boat_meant(self):
        shows = stopped_line("blue_one")
        self.assertTrue(shows("blue_one  e-stopped  after 63 ms"))
        for line in ("red_one  e-stopped  after 63 ms", "blue_one  silent", "blue_one estop", "blue_one_2  e-stopped after 1 ms"):
            self.assertFalse(shows(line), line)


class StallTest(unittest.TestCase):
    def test_a_stall_is_read(self):
        self.assertEqual(stall_in("stall 5288992229580 164.5"), (5288992229580, 164.5))


class LinkCheckTest(unittest.TestCase):
    def test_an_echo_request_sums_to_zero(self):
        self.assertEqual(checksum(echo_request(17, 3)), 0)

    def test_a_link_that_is_not_as_asked_for_is_noticed(self):
        def measured(received, median_ms):
            return {"sent": 400, "received": received, "median_ms": median_ms}

        self.assertIsNone(problem_of(measured(400, 100.4), 50.0, 0.0))
        self.assertIsNone(problem_of(measured(361, 100.4), 50.0, 5.0))
        for received, median_ms, loss_pct, words in (
            (0, None, 0.0, "nothing"), (400, 99.0, 0.0, "round trip takes"), (400, 106.0, 0.0, "round trip takes"),
            (399, 100.0, 0.0, "lost"), (400, 100.0, 5.0, "lost"), (320, 100.0, 5.0, "lost"),
        ):
            self.assertIn(words, problem_of(measured(received, median_ms), 50.0, loss_pct))


if __name__ == "__main__":
    unittest.main()
