# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the same work in several programs in turn and writes down what came of it. Needs nothing but Python 3.9."""
