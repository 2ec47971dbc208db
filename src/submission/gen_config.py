"""The competition's configuration with the observations that `solution.py` expects. Nothing else is changed."""

try:
    from pyquaticus.mctf26_config import config_dict_std
except ImportError:
    from pyquaticus.config import config_dict_std

config_dict_competition = {
    **config_dict_std,
    "normalize_obs": True,
    "lidar_obs": False,
    "short_obs_hist_length": 1,
    "short_obs_hist_interval": 1,
    "long_obs_hist_length": 1,
    "long_obs_hist_interval": 1,
}
