/* SPDX-License-Identifier: MIT */
/* The reader of masks (PGM files) and of the text of `region`: any bytes are refused with one error, or give a mask and
 * a region that the library accepts. The first byte of the input chooses which of the two the rest is. */
#include <gst/video/video.h>

#include "fuzz_gst.h"
#include "gstl1l2stabarea.h"

/* An area that fits the frames must be one that the library can be created with, unless it leaves too little. */
static void create_with(const L1L2StabConfig *cfg)
{
    L1L2Stab *s = NULL;
    const L1L2StabResult result = l1l2stab_create(&s, cfg);
    FUZZ_CHECK(result == L1L2STAB_OK || result == L1L2STAB_ERR_ARGUMENT, "%d", result);
    FUZZ_CHECK(l1l2stab_config_delay(cfg) == cfg->window, "the config is not valid");
    l1l2stab_free(&s);
}

static void apply(GstElement *element, const GstL1L2StabArea *area)
{
    GstVideoInfo video;
    L1L2StabConfig cfg;
    l1l2stab_config_init(&cfg, sizeof cfg);
    cfg.format = L1L2STAB_FORMAT_GRAY8;
    cfg.width = 64, cfg.height = 48;
    cfg.window = 4;
    cfg.threads = 1;
    gst_video_info_set_format(&video, GST_VIDEO_FORMAT_GRAY8, cfg.width, cfg.height);
    if (gst_l1l2_stab_area_apply(area, element, &video, &cfg))
        create_with(&cfg);
    else
        FUZZ_CHECK(fuzz_count_errors(element) == 1, "not one error for a region that does not fit");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    GstL1L2StabArea area = {0};
    if (size < 1)
        return 0;
    fuzz_gst_init();
    GstElement *element = fuzz_element_new();
    FuzzFile file = fuzz_file_new(data + 1, size - 1);
    char *text = g_strndup((const char *)data + 1, size - 1);
    const bool is_region = data[0] % 2;
    const bool ok = gst_l1l2_stab_area_open(&area, element, is_region ? text : NULL, is_region ? NULL : file.name);
    FUZZ_CHECK(fuzz_count_errors(element) == (ok ? 0 : 1), "not one error for a faulty area");
    if (ok)
        apply(element, &area);
    gst_l1l2_stab_area_close(&area);
    g_free(text);
    fuzz_file_free(&file);
    fuzz_element_free(element);
    return 0;
}
