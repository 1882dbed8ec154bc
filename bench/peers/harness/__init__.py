# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the same work in several programs in turn and records the results. Needs only Python 3.9."""
