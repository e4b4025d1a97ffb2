#ifndef MP_NOTES_H
#define MP_NOTES_H

#include "core/decoder.h"

/*
 * Add the notes of one more file to ${sum}, which is all 0 before the first.  Counts are added up;
 * the format is MP_FORMAT_MIXED where files differ; parts is the most of any one file (several
 * files are no news to whoever sent them, several solids in one file may be); quantisation_step is
 * the largest; rounding is unknown where files differ in it.
 */
void mp_notes_add(struct mp_notes *sum, const struct mp_notes *file);

#endif
