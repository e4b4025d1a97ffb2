#ifndef MP_BOXES_H
#define MP_BOXES_H

#include "core/report.h"

/*
 * mp_boxes_apart(box, count, out, err):
 * MP_YES where no two of the boxes share more than their sides, MP_UNDECIDED where two do or the
 * work (10^8 comparisons) did not suffice to tell.  Sweep along x, then y, then z.
 * -1: memory is out (16 bytes a box).
 */
int mp_boxes_apart(const struct mp_box *box, uint32_t count, enum mp_truth *out,
		   struct mp_error *err);

#endif
