// This library exists only for its precompiled headers, but must have a source file.
