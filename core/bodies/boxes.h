#ifndef MP_BOXES_H
#define MP_BOXES_H

#include "core/report/report.h"

/*
 * mp_boxes_apart(box, count, out, err):
 * MP_YES where no two of the boxes share more than their sides, MP_UNDECIDED where two do or the
 * work (about 10^8 steps) did not suffice to tell.  The boxes are cut into groups by planes that
 * cut no box, along the three axes in turn; what no plane cuts is compared pair by pair along a
 * sweep.  -1: memory is out (24 bytes a box).
 */
int mp_boxes_apart(const struct mp_box *box, uint32_t count, enum mp_truth *out,
		   struct mp_error *err);

#endif
