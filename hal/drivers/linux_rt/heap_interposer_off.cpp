// SPDX-License-Identifier: Apache-2.0
// Built in place of heap_interposer.cpp under a sanitizer, which has its own malloc: HeapCounterActive() is
// then false, and reports that need the count say "not measured".
