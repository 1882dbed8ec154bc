# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tables of quality and robustness share, and the options of all. Needs nothing but Python 3.9; ply.py needs numpy."""
