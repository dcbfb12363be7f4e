// SPDX-License-Identifier: GPL-3.0-or-later
// Nothing of its own: what it is compiled with is the headers that other tests reuse.
