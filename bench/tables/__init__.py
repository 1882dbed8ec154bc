# SPDX-License-Identifier: GPL-3.0-or-later
"""Shared by the benches of quality and robustness. Needs only Python 3.9; ply.py needs numpy."""
