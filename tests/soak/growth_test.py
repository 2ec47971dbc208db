"""Growth is distinguished from noise."""

import unittest

from growth import growth_of


class GrowthTest(unittest.TestCase):
    def test_a_straight_line_grows_by_its_slope_after_the_warm_up(self):
        growth = growth_of([(60.0 * i, 20.0 + 0.5 * i) for i in range(100)])
        self.assertAlmostEqual(growth.grew, 0.5 * 79)
        self.assertTrue(30.0 < growth.first < 36.0 and 64.0 < growth.last < 70.0, growth)

    def test_filling_buffers_and_odd_samples_are_no_growth(self):
        filling = [(i, float(min(i, 20))) for i in range(100)]
        self.assertEqual(growth_of(filling).grew, 0.0)
        spikes = [(i, 500.0 if i % 7 == 0 else 20.0) for i in range(100)]
        self.assertEqual(growth_of(spikes).grew, 0.0)
        self.assertEqual(growth_of([(i, 5.0 + (i == 99)) for i in range(100)]).grew, 0.0)

    def test_a_leak_in_steps_is_growth(self):
        growth = growth_of([(i, float(i // 10)) for i in range(1000)])
        self.assertAlmostEqual(growth.grew, 80.0, delta=2.0)

    def test_what_shrinks_does_not_grow_and_few_samples_tell_nothing(self):
        self.assertLess(growth_of([(i, -float(i)) for i in range(50)]).grew, 0.0)
        self.assertIsNone(growth_of([(i, float(i)) for i in range(5)]))
        self.assertIsNone(growth_of([]))


if __name__ == "__main__":
    unittest.main()
