/* SPDX-License-Identifier: MIT */
#include "fuzz_gst.h"

#include <sys/mman.h>
#include <unistd.h>

#include "gstl1l2stab.h"

void fuzz_gst_init(void)
{
    static bool is_ready;
    if (is_ready)
        return;
    is_ready = true;
    setenv("GST_REGISTRY_DISABLE", "yes", 1);
    gst_init(NULL, NULL);
    gst_debug_set_default_threshold(GST_LEVEL_NONE);
    g_log_set_always_fatal(G_LOG_LEVEL_CRITICAL | G_LOG_LEVEL_ERROR);
}

GstElement *fuzz_element_new(void)
{
    GstElement *element = g_object_new(GST_TYPE_L1L2_STAB, NULL);
    GstBus *bus = gst_bus_new();
    gst_object_ref_sink(element);
    gst_element_set_bus(element, bus);
    gst_object_unref(bus);
    return element;
}

void fuzz_element_free(GstElement *element)
{
    gst_element_set_state(element, GST_STATE_NULL);
    /* A bus that is freed with its messages frees pads, under a lock that they need. */
    fuzz_count_errors(element);
    gst_element_set_bus(element, NULL);
    FUZZ_CHECK(GST_OBJECT_REFCOUNT_VALUE(element) == 1, "%d references", GST_OBJECT_REFCOUNT_VALUE(element));
    gst_object_unref(element);
}

int fuzz_count_errors(GstElement *element)
{
    GstBus *bus = gst_element_get_bus(element);
    int errors = 0;
    for (GstMessage *message; (message = gst_bus_pop(bus)); gst_message_unref(message)) {
        GError *error = NULL;
        if (GST_MESSAGE_TYPE(message) != GST_MESSAGE_ERROR)
            continue;
        gst_message_parse_error(message, &error, NULL);
        FUZZ_CHECK(error->message[0], "an error without a text");
        g_error_free(error);
        errors++;
    }
    gst_object_unref(bus);
    return errors;
}

FuzzFile fuzz_file_new(const uint8_t *data, size_t size)
{
    FuzzFile file = {.fd = memfd_create("fuzz", MFD_CLOEXEC)};
    FUZZ_CHECK(file.fd >= 0, "no memory file");
    FUZZ_CHECK(write(file.fd, data, size) == (ssize_t)size, "cannot write");
    snprintf(file.name, sizeof file.name, "/proc/self/fd/%d", file.fd);
    return file;
}

void fuzz_file_free(FuzzFile *file)
{
    close(file->fd);
}
