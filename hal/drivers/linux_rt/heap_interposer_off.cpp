// Built in place of heap_interposer.cpp under a sanitizer, which brings a malloc of its own:
// HeapCounterActive() then answers no, and what depends on the count says "not measured".
