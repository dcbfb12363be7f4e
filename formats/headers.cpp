// SPDX-License-Identifier: MIT
// Nothing of its own: what it is compiled with is the headers that other libraries reuse.
