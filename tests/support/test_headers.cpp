// SPDX-License-Identifier: MIT
// Nothing but the headers that all tests share: CMakeLists.txt has them compiled beforehand.
